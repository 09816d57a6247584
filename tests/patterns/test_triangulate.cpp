// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/triangulate.h"

#include "geometry/edges.h"
#include "geometry/parallel.h"
#include "patterns/curve.h"
#include "tests/support/draw.h"
#include "tests/support/flat_quality.h"
#include "tests/support/random.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

namespace {

TriangulateOptions at(double edge_length, int levels = 1) {
    TriangulateOptions options;
    options.edge_length = edge_length;
    options.levels = levels;
    return options;
}

Pattern one(Panel panel) {
    Pattern pattern;
    pattern.name = "one panel";
    pattern.panels = {std::move(panel)};
    return pattern;
}

/// Holds for every level of every pattern: what a solver takes for granted.
void check_sound(const Pattern& pattern, const FlatLevel& level) {
    // Every point is used, and by its own panel.
    std::vector<bool> used(level.points.size(), false);
    for (std::size_t t = 0; t < level.triangles.size(); ++t)
        for (int v : level.triangles[t]) {
            used[v] = true;
            REQUIRE(level.panel_of_point[v] == level.panel_of_triangle[t]);
        }
    CHECK(std::count(used.begin(), used.end(), false) == 0);
    // One connected piece per panel, its front on the fabric's right side.
    CHECK(count_pieces(level.triangles, int(level.points.size())) == int(pattern.panels.size()));
    for (int t = 0; t < int(level.triangles.size()); ++t) {
        const double outline = signed_area(pattern.panels[level.panel_of_triangle[t]].outline);
        REQUIRE(doubled_area(level, t) * outline > 0);
    }
    // Edges of the outline are border edges of the mesh, unsplit, and end in the exact corners.
    const auto uses = edge_uses(level);
    for (std::size_t p = 0; p < pattern.panels.size(); ++p)
        for (std::size_t e = 0; e < pattern.panels[p].outline.size(); ++e) {
            const std::vector<int>& line = level.border[p][e];
            REQUIRE(line.size() >= 2);
            CHECK(level.points[line.front()] == pattern.panels[p].outline[e].start);
            CHECK(level.points[line.back()] == pattern.panels[p].outline[e].end);
            for (std::size_t k = 0; k + 1 < line.size(); ++k) {
                const auto found =
                    uses.find({std::min(line[k], line[k + 1]), std::max(line[k], line[k + 1])});
                REQUIRE(found != uses.end());
                CHECK(found->second == 1);
            }
        }
}

FlatPattern sound(const Pattern& pattern, const TriangulateOptions& options) {
    FlatPattern flat = triangulate(pattern, options);
    REQUIRE(int(flat.levels.size()) == options.levels);
    for (const FlatLevel& level : flat.levels)
        check_sound(pattern, level);
    return flat;
}

double area(const FlatLevel& level) {
    double sum = 0;
    for (int t = 0; t < int(level.triangles.size()); ++t)
        sum += std::abs(doubled_area(level, t)) / 2;
    return sum;
}

/// Fractions of arc length at which a straight edge is sampled.
std::vector<double> fractions(const FlatLevel& level, int panel, int edge) {
    const std::vector<int>& line = level.border[panel][edge];
    std::vector<double> out;
    const Vec2 start = level.points[line.front()], end = level.points[line.back()];
    for (int v : line)
        out.push_back((level.points[v] - start).norm() / (end - start).norm());
    return out;
}

bool has_fraction(const FlatLevel& level, int panel, int edge, double t) {
    for (double f : fractions(level, panel, edge))
        if (std::abs(f - t) < 1e-9) return true;
    return false;
}

} // namespace

TEST_CASE("a rectangle is filled with nearly equilateral triangles of the wanted size") {
    for (double edge : {0.05, 0.02, 0.01, 0.005}) {
        const Pattern pattern = one(rectangle("sheet", 0.53, 0.31));
        const FlatLevel level = sound(pattern, at(edge)).levels[0];
        CHECK(area(level) == Approx(0.53 * 0.31).epsilon(1e-12));
        const FlatQuality q = measure(level, 0);
        CHECK(q.mean_ratio == Approx(1).epsilon(0.05));
        CHECK(q.smallest_of_all > 25);
    }
}

TEST_CASE("angles and mean edge hold for random outlines") {
    Random random(7);
    for (int trial = 0; trial < 40; ++trial) {
        // Star-shaped about the origin, so that it cannot cross itself.
        const int n = 5 + random.below(8);
        std::vector<Vec2> corners;
        for (int k = 0; k < n; ++k) {
            const double angle = 2 * EIGEN_PI * (k + random.in(-0.3, 0.3)) / n, radius = random.in(0.15, 0.5);
            corners.push_back(radius * Vec2(std::cos(angle), std::sin(angle)));
        }
        if (trial % 2) std::reverse(corners.begin(), corners.end());
        Pattern pattern = one(polygon("star", corners));
        if (trial % 3 == 0) // one curved edge that stays inside the star's neighbours
            pattern.panels[0].outline[0].curve = Quadratic{0.55 * (corners[0] + corners[1])};
        CAPTURE(trial);
        for (const FlatLevel& level : sound(pattern, at(0.02, 2)).levels) {
            // A wedge below 60 degrees is narrower than an edge for up to two edges from its tip.
            const FlatQuality q = measure(level, 2);
            CHECK(q.mean_ratio == Approx(1).epsilon(0.05));
            CHECK(q.smallest_angle > 25);
        }
    }
}

namespace {

/// How a level's inner edges lie to the grain.
struct AlongGrain {
    double share = 0;    ///< of edges none of whose ends is on the border, along warp or weft within 1e-6
    double diagonal = 0; ///< of the others, those within a degree of 45 from it
    double mean = 0;     ///< of the length of those along it, over the edge length
};

AlongGrain along_grain(const FlatLevel& level, const std::vector<double>& grain) {
    std::set<int> border;
    const auto uses = edge_uses(level);
    for (const auto& [edge, n] : uses)
        if (n == 1) border.insert(edge.begin(), edge.end());
    int inner = 0, along = 0, diagonal = 0;
    double length = 0;
    for (const auto& [edge, n] : uses) {
        if (border.count(edge[0]) || border.count(edge[1])) continue;
        const Vec2 d = level.points[edge[1]] - level.points[edge[0]];
        const double turn = std::atan2(d.y(), d.x()) - grain[level.panel_of_point[edge[0]]];
        ++inner;
        if (std::abs(std::sin(2 * turn)) < 2e-6) {
            ++along;
            length += d.norm();
        } else {
            diagonal += std::abs(std::cos(2 * turn)) < std::sin(2 * EIGEN_PI / 180);
        }
    }
    return {double(along) / inner, double(diagonal) / (inner - along), length / along / level.edge_length};
}

TriangulateOptions lattice_at(double edge_length, int levels = 1) {
    TriangulateOptions options = at(edge_length, levels);
    options.grain_lattice = true;
    return options;
}

} // namespace

TEST_CASE("with a lattice along the grain, a rectangle cut along it consists of halved squares alone") {
    const double grain = GENERATE(EIGEN_PI / 2, 0.0);
    Pattern pattern = one(rectangle("sheet", 0.52, 0.31));
    pattern.panels[0].grain = grain;
    for (const FlatLevel& level : sound(pattern, lattice_at(0.02, 3)).levels) {
        const int columns = int(level.border[0][0].size()) - 1, rows = int(level.border[0][1].size()) - 1;
        int across = 0, along = 0, other = 0;
        for (const auto& [edge, n] : edge_uses(level)) {
            const Vec2 d = (level.points[edge[1]] - level.points[edge[0]]).cwiseAbs();
            (d.y() < 1e-12 ? across : d.x() < 1e-12 ? along : other) += 1;
        }
        CHECK(area(level) == Approx(0.52 * 0.31).epsilon(1e-12));
        CHECK(across == columns * (rows + 1));
        CHECK(along == rows * (columns + 1));
        CHECK(other == columns * rows);
        CHECK(measure(level, 0).smallest_of_all > 40);
    }
}

TEST_CASE("with a lattice along the grain, inner edges lie along warp and weft whatever the outline") {
    Random random(7);
    for (int trial = 0; trial < 30; ++trial) {
        const int n = 5 + random.below(8);
        std::vector<Vec2> corners;
        for (int k = 0; k < n; ++k) {
            const double angle = 2 * EIGEN_PI * (k + random.in(-0.3, 0.3)) / n, radius = random.in(0.15, 0.5);
            corners.push_back(radius * Vec2(std::cos(angle), std::sin(angle)));
        }
        Pattern pattern = one(polygon("star", corners));
        pattern.panels[0].grain = trial % 4 == 0 ? EIGEN_PI / 2 : random.in(0, EIGEN_PI);
        CAPTURE(trial);
        const FlatPattern flat = sound(pattern, lattice_at(0.02, 2));
        for (const FlatLevel& level : flat.levels) CHECK(measure(level, 2).smallest_angle > 22);
        const AlongGrain g = along_grain(flat.levels.back(), {pattern.panels[0].grain});
        CHECK(g.mean == Approx(1).epsilon(0.34));
        CHECK(g.share > 0.62); // of all two in three, but for points added where the border leaves room
        CHECK(g.diagonal > 0.8);
    }
}

TEST_CASE("an outline that runs clockwise is triangulated clockwise, elsewise alike") {
    const FlatLevel up = sound(one(rectangle("p", 0.2, 0.3)), at(0.02)).levels[0];
    const FlatLevel down =
        sound(one(polygon("p", {{0, 0}, {0, 0.3}, {0.2, 0.3}, {0.2, 0}})), at(0.02)).levels[0];
    CHECK(doubled_area(up, 0) > 0);
    CHECK(doubled_area(down, 0) < 0);
    CHECK(up.points.size() == down.points.size());
}

TEST_CASE("both sides of a seam carry equally many samples at equal fractions, whatever their lengths") {
    for (double ratio : {1.0, 1.03, 1.5, 2.2}) {
        Pattern pattern;
        pattern.panels = {rectangle("short", 0.3, 0.2), rectangle("long", 0.3 * ratio, 0.2)};
        pattern.seams = {seam("hem", {whole(0, 2)}, {backward(1, 0)})};
        const FlatPattern flat = sound(pattern, at(0.01, 3));
        for (const FlatLevel& level : flat.levels) {
            const auto& stitches = level.stitches[0];
            REQUIRE(stitches.size() == level.border[0][2].size());
            REQUIRE(stitches.size() == level.border[1][0].size());
            CHECK(level.sewn[0].size() + 1 == stitches.size());
            for (std::size_t k = 0; k < stitches.size(); ++k) {
                const Vec2 a = level.points[stitches[k][0]], b = level.points[stitches[k][1]];
                CHECK(a.y() == Approx(0.2));
                CHECK(b.y() == Approx(0).margin(1e-12));
                CHECK(a.x() / 0.3 == Approx(b.x() / (0.3 * ratio)).margin(1e-9)); // ease is shared evenly
            }
        }
        const FlatLevel& fine = flat.levels.back();
        const double spacing_short = 0.3 / double(fine.sewn[0].size()), spacing_long = spacing_short * ratio;
        CHECK(spacing_short > 0.6 * 0.01);
        CHECK(spacing_long < 1.6 * 0.01);
    }
}

TEST_CASE("a side of several spans meets a side of other spans") {
    // A waistband of one edge (0.6 m) sewn to a front of 0.35 m and a back of 0.25 m: its samples include the
    // place where they meet, which the band itself knows nothing of.
    Pattern pattern;
    pattern.panels = {rectangle("band", 0.6, 0.04), rectangle("front", 0.35, 0.3),
                      rectangle("back", 0.25, 0.3)};
    pattern.seams = {seam("waist", {whole(0, 0)}, {backward(1, 2), backward(2, 2)})};
    const FlatLevel level = sound(pattern, at(0.02)).levels[0];
    CHECK(has_fraction(level, 0, 0, 0.35 / 0.6));
    const std::size_t band = level.border[0][0].size(), front = level.border[1][2].size(),
                      back = level.border[2][2].size();
    CHECK(band == front + back - 1);
    CHECK(level.stitches[0].size() == band + 1); // the meeting place has two partners
    CHECK(level.sewn[0].size() == band - 1);
}

TEST_CASE("notches on both sides of a seam are joined or carried across") {
    Pattern pattern;
    pattern.panels = {rectangle("a", 0.4, 0.2), rectangle("b", 0.2, 0.2), rectangle("c", 0.2, 0.2),
                      rectangle("d", 0.1, 0.2), rectangle("e", 0.3002, 0.2)};
    SECTION("two against two, with junctions far apart") {
        pattern.seams = {seam("s", {whole(1, 0), whole(2, 0)}, {whole(3, 0), whole(4, 0)})};
        const FlatLevel level = sound(pattern, at(0.02)).levels[0];
        CHECK(has_fraction(level, 1, 0, 0.1 / 0.4002 * 2));
        CHECK(level.sewn[0].size() == level.border[1][0].size() + level.border[2][0].size() - 2);
        CHECK(level.sewn[0].size() == level.border[3][0].size() + level.border[4][0].size() - 2);
    }
    SECTION("junctions that nearly meet are one place: no sliver") {
        pattern.panels[3] = rectangle("d", 0.2004, 0.2);
        pattern.panels[4] = rectangle("e", 0.2, 0.2);
        pattern.seams = {seam("s", {whole(1, 0), whole(2, 0)}, {whole(3, 0), whole(4, 0)})};
        const FlatLevel level = sound(pattern, at(0.02)).levels[0];
        CHECK(level.border[1][0].size() == level.border[3][0].size());
        CHECK(level.border[1][0].size() == 11);
    }
    SECTION("part of an edge, from notch to notch") {
        pattern.seams = {seam("s", {{0, 0, 0.25, 0.75}}, {whole(1, 0)}),
                         seam("t", {{0, 0, 1, 0.75}}, {whole(3, 0)})};
        const FlatLevel level = sound(pattern, at(0.02)).levels[0];
        CHECK(has_fraction(level, 0, 0, 0.25));
        CHECK(has_fraction(level, 0, 0, 0.75));
        CHECK(level.sewn[0].size() == level.border[1][0].size() - 1);
        CHECK(level.points[level.stitches[1].front()[0]] == Vec2(0.4, 0)); // walked backward from the corner
    }
}

TEST_CASE("counts agree along chains of seams") {
    // a - b - c - d one after the other, each longer: all four edges carry the same count.
    Pattern pattern;
    for (int k = 0; k < 4; ++k)
        pattern.panels.push_back(rectangle("p" + std::to_string(k), 0.2 * std::pow(1.2, k), 0.1));
    for (int k = 0; k < 3; ++k)
        pattern.seams.push_back(
            seam("s" + std::to_string(k), {whole(k, 2)}, {backward(k + 1, k == 1 ? 2 : 0)}));
    // Seam 1 joins the upper edge of 1 to the upper of 2; edge 2 of panel 1 is thus in two chains.
    const FlatLevel level = sound(pattern, at(0.01)).levels[0];
    for (const auto& s : level.sewn)
        CHECK(!s.empty());
    CHECK(level.border[0][2].size() == level.border[1][0].size());
    CHECK(level.border[1][2].size() == level.border[2][2].size());
    CHECK(level.border[2][2].size() == level.border[3][0].size());
}

TEST_CASE("random seams of random spans, overlapping ones too, are matched or refused") {
    Random random(11);
    int made = 0;
    for (int trial = 0; trial < 80; ++trial) {
        CAPTURE(trial);
        Pattern pattern;
        const int panels = 3 + random.below(4);
        for (int p = 0; p < panels; ++p)
            pattern.panels.push_back(
                rectangle("p" + std::to_string(p), random.in(0.05, 0.6), random.in(0.05, 0.6)));
        auto side = [&] {
            SeamSide out;
            const int spans = 1 + random.below(3);
            for (int k = 0; k < spans; ++k) {
                const double t0 = random.below(5) / 4.0;
                double t1 = random.below(2) ? random.unit() : random.below(5) / 4.0;
                if (std::abs(t1 - t0) < 0.1) t1 = t0 > 0.5 ? 0 : 1;
                out.push_back({random.below(panels), random.below(4), t0, t1});
            }
            return out;
        };
        for (int s = 0; s < 4; ++s)
            pattern.seams.push_back(seam("seam " + std::to_string(s), side(), side()));
        FlatPattern flat;
        try {
            flat = triangulate(pattern, at(0.02, 2));
        } catch (const std::runtime_error& e) {
            CHECK_THAT(e.what(), Catch::Contains("seam"));
            continue;
        }
        ++made;
        for (const FlatLevel& level : flat.levels) {
            check_sound(pattern, level);
            for (std::size_t s = 0; s < 4; ++s) {
                double walked_a = 0, walked_b = 0, a = 0, b = 0;
                auto length_of = [&](const std::array<int, 2>& e) {
                    return (level.points[e[1]] - level.points[e[0]]).norm();
                };
                for (const SewnSegment& segment : level.sewn[s])
                    a += length_of(segment.a), b += length_of(segment.b);
                for (const EdgeSpan& span : pattern.seams[s].a)
                    walked_a +=
                        std::abs(span.t1 - span.t0) * length(pattern.panels[span.panel].outline[span.edge]);
                CHECK(a == Approx(walked_a)); // the whole side is sewn
                walked_a = 0;
                for (const SewnSegment& segment : level.sewn[s]) {
                    walked_a += length_of(segment.a), walked_b += length_of(segment.b);
                    CHECK(std::abs(walked_a / a - walked_b / b) < 4 * 0.003 / std::max(a, b)); // ease is even
                }
            }
        }
    }
    CHECK(made > 40);
}

TEST_CASE("overlapping seams on one edge join three layers") {
    Pattern pattern;
    pattern.panels = {rectangle("shell", 0.4, 0.2), rectangle("lining", 0.4, 0.2),
                      rectangle("band", 0.4, 0.04)};
    pattern.seams = {seam("s", {whole(0, 2)}, {whole(1, 2)}), seam("t", {whole(0, 2)}, {whole(2, 0)})};
    const FlatLevel level = sound(pattern, at(0.02)).levels[0];
    CHECK(level.border[1][2].size() == level.border[2][0].size());
}

TEST_CASE("a dart keeps its tip, and the tip is not sewn to itself") {
    // A dart of 13 degrees from the waist.
    const double depth = 0.1, half = depth * std::tan(6.5 * EIGEN_PI / 180);
    Pattern pattern = one(polygon("skirt", {{0, 0},
                                            {0.3, 0},
                                            {0.3, 0.4},
                                            {0.15 + half, 0.4},
                                            {0.15, 0.4 - depth},
                                            {0.15 - half, 0.4},
                                            {0, 0.4}}));
    pattern.seams = {seam("dart", {whole(0, 3)}, {backward(0, 4)})};
    for (const FlatLevel& level : sound(pattern, at(0.01, 4)).levels) {
        const int tip = level.border[0][3].back();
        CHECK(level.points[tip] == Vec2(0.15, 0.4 - depth));
        for (const auto& [a, b] : level.stitches[0]) {
            CHECK(a != tip);
            CHECK(b != tip);
            CHECK(level.points[a].y() == Approx(level.points[b].y()));
        }
        CHECK(level.sewn[0].back().a[1] == tip);
        CHECK(level.sewn[0].back().b[1] == tip);
    }
}

TEST_CASE("sharp corners, very short edges and narrow strips survive every level") {
    Pattern pattern;
    const double tip = 0.3 * std::tan(13 * EIGEN_PI / 180);
    pattern.panels = {polygon("wedge", {{0, 0}, {0.3, 0}, {0.3, tip}}),
                      polygon("nick", {{0, 0}, {0.3, 0}, {0.3, 0.2}, {0.15075, 0.2}, {0.15, 0.2}, {0, 0.2}}),
                      rectangle("collar", 0.4, 0.03)};
    const FlatPattern flat = sound(pattern, at(0.01, 4));
    for (const FlatLevel& level : flat.levels) {
        CHECK(level.border[1][3].size() == 2); // 0.75 mm stay one sample
        CHECK(measure(level, 2).smallest_angle > 15);
    }
    CHECK(measure(flat.levels.back(), 2).smallest_angle > 25);
}

TEST_CASE("levels nest: coarse border samples are every second fine one, or all of them") {
    Pattern pattern;
    pattern.panels = {
        rectangle("a", 0.437, 0.061),
        polygon("b", {{0, 0}, {0.437, 0.02}, {0.4, 0.3}, {0.1, 0.31}, {0.0995, 0.31}, {0, 0.3}})};
    pattern.panels[1].outline[1].curve = Arc{0.25, false, true};
    pattern.seams = {seam("s", {whole(0, 2)}, {backward(1, 0)})};
    const FlatPattern flat = sound(pattern, at(0.01, 4));
    CHECK(flat.prolongation.size() == 3);
    for (int l = 0; l + 1 < 4; ++l) {
        const FlatLevel &coarse = flat.levels[l], &fine = flat.levels[l + 1];
        CHECK(coarse.edge_length == Approx(2 * fine.edge_length));
        REQUIRE(flat.prolongation[l].size() == fine.points.size());
        for (std::size_t p = 0; p < pattern.panels.size(); ++p)
            for (std::size_t e = 0; e < pattern.panels[p].outline.size(); ++e) {
                const std::vector<int>&c = coarse.border[p][e], &f = fine.border[p][e];
                const std::size_t step = (f.size() - 1) / (c.size() - 1);
                REQUIRE((step == 1 || step == 2));
                REQUIRE((c.size() - 1) * step == f.size() - 1);
                for (std::size_t k = 0; k < f.size(); ++k) {
                    const Interpolation& from = flat.prolongation[l][f[k]];
                    if (k % step == 0) {
                        CHECK(fine.points[f[k]] == coarse.points[c[k / step]]);
                        CHECK(from.from[0] == c[k / step]);
                        CHECK(from.weight[0] == 1);
                    } else {
                        CHECK(from.from[0] == c[k / 2]);
                        CHECK(from.from[1] == c[k / 2 + 1]);
                        CHECK((from.weight[0] == 0.5 && from.weight[1] == 0.5));
                    }
                }
            }
    }
}

TEST_CASE("prolongation reproduces the flat shape") {
    Pattern pattern = one(polygon("p", {{0, 0}, {0.5, 0.1}, {0.4, 0.4}, {0.2, 0.25}, {0, 0.35}}));
    const bool curved = GENERATE(false, true), lattice = GENERATE(false, true);
    if (curved) pattern.panels[0].outline[0].curve = Arc{0.5, false, true};
    const FlatPattern flat = sound(pattern, lattice ? lattice_at(0.01, 4) : at(0.01, 4));
    for (std::size_t l = 0; l + 1 < flat.levels.size(); ++l)
        for (std::size_t v = 0; v < flat.levels[l + 1].points.size(); ++v) {
            const Interpolation& i = flat.prolongation[l][v];
            Vec2 p = Vec2::Zero();
            double sum = 0;
            for (int k = 0; k < 3; ++k) {
                REQUIRE(flat.levels[l].panel_of_point[i.from[k]] == flat.levels[l + 1].panel_of_point[v]);
                CHECK(i.weight[k] >= -0.5);
                p += i.weight[k] * flat.levels[l].points[i.from[k]];
                sum += i.weight[k];
            }
            CHECK(sum == Approx(1));
            // On a curved border a point leaves its chord by the sag, an eighth of the coarse target at most.
            const double slack = curved ? flat.levels[l].edge_length / 8 : 1e-12;
            CHECK((p - flat.levels[l + 1].points[v]).norm() <= slack);
        }
}

TEST_CASE("holes stay open and inner lines are edges of the mesh") {
    Pattern pattern = one(rectangle("p", 0.4, 0.3));
    Panel& panel = pattern.panels[0];
    panel.holes = {polygon_loop({{0.1, 0.1}, {0.15, 0.1}, {0.15, 0.2}, {0.1, 0.2}})};
    panel.lines = {{{{{0.2, 0}, {0.2, 0.3}, Straight{}, ""}}, InnerLineKind::fold, 0.5}, // from edge to edge
                   {{{{0.25, 0.1}, {0.3, 0.15}, Straight{}, ""}, {{0.3, 0.15}, {0.35, 0.1}, Straight{}, ""}},
                    InnerLineKind::pleat,
                    0}};
    for (const FlatLevel& level : sound(pattern, at(0.01, 3)).levels) {
        CHECK(area(level) == Approx(0.4 * 0.3 - 0.05 * 0.1).epsilon(1e-9));
        const auto uses = edge_uses(level);
        for (const std::vector<int>& line : level.lines[0]) {
            REQUIRE(line.size() >= 2);
            for (std::size_t k = 0; k + 1 < line.size(); ++k) {
                const auto found =
                    uses.find({std::min(line[k], line[k + 1]), std::max(line[k], line[k + 1])});
                REQUIRE(found != uses.end());
                CHECK(found->second == 2);
            }
        }
        CHECK((level.points[level.lines[0][0].front()] - Vec2(0.2, 0)).norm() < 1e-10);
        CHECK(has_fraction(level, 0, 0, 0.5)); // the fold's end is a sample of the outline
        CHECK(level.points[level.lines[0][1].back()] == Vec2(0.35, 0.1));
    }
}

TEST_CASE("inner lines may end on each other in any order") {
    // A pinwheel: each line starts on the next-to-last stretch of the one before, the first one on the last.
    const bool cornered = GENERATE(false, true); // lines of two edges that meet where the next line starts
    Pattern pattern = one(rectangle("p", 0.4, 0.4));
    const std::vector<Vec2> corners{{0.1, 0.1}, {0.3, 0.1}, {0.3, 0.3}, {0.1, 0.3}};
    for (int k = 0; k < 4; ++k) {
        const Vec2 start = corners[k], turn = corners[(k + 1) % 4], end = turn + 0.2 * (turn - start);
        Loop line{{start, end, Straight{}, ""}};
        if (cornered) line = {{start, turn, Straight{}, ""}, {turn, end, Straight{}, ""}};
        pattern.panels[0].lines.push_back({line, InnerLineKind::fold, 0});
    }
    for (const FlatLevel& level : sound(pattern, at(0.02, 3)).levels)
        for (int k = 0; k < 4; ++k) {
            const std::vector<int>&line = level.lines[0][k], &before = level.lines[0][(k + 3) % 4];
            CHECK(std::count(before.begin() + 1, before.end() - 1, line.front()) == 1);
        }
}

TEST_CASE("border places are fractions of arc length") {
    Pattern pattern = one(rectangle("p", 0.4, 0.3));
    pattern.panels[0].outline[0].curve = Arc{0.3, false, true};
    pattern.pins = {{{0, 0, 0.2, 0.6}}};
    for (const FlatLevel& level : sound(pattern, at(0.02, 2)).levels) {
        const std::vector<double>& places = level.border_at[0][0];
        const std::vector<int>& ids = level.border[0][0];
        REQUIRE(places.size() == ids.size());
        for (std::size_t k = 0; k < ids.size(); ++k)
            CHECK(
                (level.points[ids[k]] - sample(pattern.panels[0].outline[0], 0, places[k], 1).back()).norm() <
                1e-12);
        CHECK(std::count(places.begin(), places.end(), 0.2) == 1); // pins end in samples
        CHECK(std::count(places.begin(), places.end(), 0.6) == 1);
    }
}

TEST_CASE("a cut opens the cloth") {
    Pattern pattern = one(rectangle("p", 0.4, 0.3));
    Panel& panel = pattern.panels[0];
    SECTION("inside: both ends stay closed") {
        panel.lines = {{{{{0.1, 0.15}, {0.3, 0.15}, Straight{}, ""}}, InnerLineKind::cut, 0}};
        const FlatPattern flat = sound(pattern, at(0.02, 2));
        for (const FlatLevel& level : flat.levels) {
            const auto uses = edge_uses(level);
            int border = 0;
            for (const auto& [edge, n] : uses)
                border += n == 1;
            int outline = 0;
            for (const auto& line : level.border[0])
                outline += int(line.size()) - 1;
            CHECK(border == outline + 2 * (int(level.lines[0][0].size()) - 1));
            CHECK(area(level) == Approx(0.12));
            // On its left (above, the line running to +x) lie the line's own vertices.
            for (const Triangle& t : level.triangles)
                for (int v : t)
                    if (std::count(level.lines[0][0].begin() + 1, level.lines[0][0].end() - 1, v))
                        CHECK((level.points[t[0]] + level.points[t[1]] + level.points[t[2]]).y() / 3 > 0.15);
        }
        // Both sides prolong from their own side.
        const FlatLevel& fine = flat.levels[1];
        std::map<std::pair<double, double>, std::vector<int>> at_place;
        for (std::size_t v = 0; v < fine.points.size(); ++v)
            at_place[{fine.points[v].x(), fine.points[v].y()}].push_back(int(v));
        int twins = 0;
        for (const auto& [place, vertices] : at_place) {
            if (vertices.size() < 2) continue;
            ++twins;
            const auto &a = flat.prolongation[0][vertices[0]], &b = flat.prolongation[0][vertices[1]];
            CHECK((a.from != b.from));
        }
        CHECK(twins == int(fine.lines[0][0].size()) - 2);
    }
    SECTION("from the edge: the border has two samples at its mouth") {
        panel.lines = {{{{{0.2, 0}, {0.2, 0.2}, Straight{}, ""}}, InnerLineKind::cut, 0}};
        const FlatPattern flat = triangulate(pattern, at(0.02, 2));
        for (const FlatLevel& level : flat.levels) {
            const std::vector<int>& hem = level.border[0][0];
            int at_mouth = 0;
            for (int v : hem)
                at_mouth += (level.points[v] - Vec2(0.2, 0)).norm() < 1e-10;
            CHECK(at_mouth == 2);
            CHECK(count_pieces(level.triangles, int(level.points.size())) == 1);
        }
    }
    SECTION("from edge to edge: two pieces") {
        panel.lines = {{{{{0.2, 0}, {0.2, 0.3}, Straight{}, ""}}, InnerLineKind::cut, 0}};
        const FlatPattern flat = triangulate(pattern, at(0.02));
        CHECK(count_pieces(flat.levels[0].triangles, int(flat.levels[0].points.size())) == 2);
    }
}

TEST_CASE("a size function makes the mesh finer where it says, on both sides of a seam") {
    Pattern pattern = tube(0.4, 0.4);
    TriangulateOptions options = at(0.02, 2);
    options.size = [](int panel, const Vec2& p) {
        return panel == 0 ? 0.3 + 0.7 * std::min(1.0, p.y() / 0.3) : 1.0;
    };
    const FlatPattern flat = sound(pattern, options);
    for (const FlatLevel& level : flat.levels) {
        for (const auto& segments : level.sewn)
            for (const SewnSegment& s : segments)
                for (int k = 0; k < 2; ++k)
                    CHECK(level.points[s.a[k]].y() == Approx(level.points[s.b[k]].y()));
        double low = 0, high = 0;
        int lows = 0, highs = 0;
        for (const auto& [edge, n] : edge_uses(level)) {
            if (level.panel_of_point[edge[0]] != 0) continue;
            const Vec2 middle = (level.points[edge[0]] + level.points[edge[1]]) / 2;
            const double ratio = (level.points[edge[1]] - level.points[edge[0]]).norm() / level.edge_length;
            if (middle.y() < 0.05) low += ratio, ++lows;
            if (middle.y() > 0.3) high += ratio, ++highs;
        }
        CHECK(low / lows == Approx(0.36).epsilon(0.12));
        CHECK(high / highs == Approx(1).epsilon(0.08));
    }
    const FlatLevel& fine = flat.levels.back();
    for (std::size_t t = 0; t < fine.triangles.size(); ++t)
        if (fine.panel_of_triangle[t] == 0)
            for (int k = 0; k < 3; ++k)
                CHECK(corner_angle(fine, fine.triangles[t], k) * 180 / EIGEN_PI > 25);
}

TEST_CASE("coarse levels of small tubes can still be closed") {
    // A cuff of 0.16 m at a target of 0.16 m: two segments round would close flat onto each other.
    Pattern pattern = tube(0.08, 0.03);
    for (const FlatLevel& level : sound(pattern, at(0.02, 4)).levels) {
        CHECK(level.border[0][0].size() + level.border[1][0].size() - 2 >= 3);
    }
}

TEST_CASE("an outline that crosses itself is refused with its edges named") {
    Pattern pattern = one(polygon("bow", {{0, 0}, {0.2, 0.2}, {0.2, 0}, {0, 0.2}}));
    CHECK_THROWS_WITH(triangulate(pattern, at(0.02)),
                      Catch::Contains("'bow'") && Catch::Contains("edge 0") && Catch::Contains("edge 2"));
    pattern = one(rectangle("spike", 0.2, 0.2));
    pattern.panels[0].outline = polygon_loop({{0, 0}, {0.2, 0}, {0.3, 0}, {0.2, 0}, {0.2, 0.2}, {0, 0.2}});
    CHECK_THROWS_WITH(triangulate(pattern, at(0.02)), Catch::Contains("'spike'"));
}

TEST_CASE("chords of a narrow crescent do not cross at coarse levels") {
    // Two arcs 6 mm apart at their middle: chords of 80 mm would cut through each other.
    Panel panel;
    panel.name = "crescent";
    panel.outline = {{{0, 0}, {0.2, 0}, Arc{0.11, false, true}, ""},
                     {{0.2, 0}, {0, 0}, Arc{0.115, false, false}, ""}};
    const Pattern pattern = one(panel);
    for (const FlatLevel& level : sound(pattern, at(0.01, 4)).levels)
        CHECK(area(level) > 0);
}

TEST_CASE("senseless options are refused") {
    const Pattern pattern = one(rectangle("p", 1, 1));
    CHECK_THROWS_AS(triangulate(pattern, at(0)), std::invalid_argument);
    CHECK_THROWS_AS(triangulate(pattern, at(-1)), std::invalid_argument);
    CHECK_THROWS_AS(triangulate(pattern, at(std::nan(""))), std::invalid_argument);
    CHECK_THROWS_AS(triangulate(pattern, at(0.01, 0)), std::invalid_argument);
    TriangulateOptions graded = lattice_at(0.02);
    graded.size = [](int, const Vec2&) { return 0.5; };
    CHECK_THROWS_WITH(triangulate(pattern, graded), Catch::Contains("size function"));
    CHECK_THROWS_WITH(triangulate(one(rectangle("p", 100, 100)), at(0.001)),
                      Catch::Contains("million triangles"));
}

TEST_CASE("triangulation does not depend on the number of threads") {
    Pattern pattern;
    Random random(3);
    for (int k = 0; k < 6; ++k)
        pattern.panels.push_back(
            rectangle("p" + std::to_string(k), random.in(0.1, 0.4), random.in(0.1, 0.4)));
    set_threads(1);
    const FlatPattern a = triangulate(pattern, at(0.01, 2));
    set_threads(4);
    const FlatPattern b = triangulate(pattern, at(0.01, 2));
    set_threads(0);
    for (int l = 0; l < 2; ++l) {
        CHECK(a.levels[l].points == b.levels[l].points);
        CHECK(a.levels[l].triangles == b.levels[l].triangles);
    }
}
