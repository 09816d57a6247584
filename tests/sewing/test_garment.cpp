// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/garment.h"

#include "patterns/curve.h"
#include "tests/support/draw.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <map>
#include <numeric>

using namespace toile;
using namespace toile::test;

namespace {

FlatLevel flat_level(const Pattern& pattern, double edge_length) {
    TriangulateOptions options;
    options.edge_length = edge_length;
    return triangulate(pattern, options).levels[0];
}

Garment sewn(const Pattern& pattern, double edge_length) {
    return sew(pattern, flat_level(pattern, edge_length));
}

/// Vertices - edges + triangles of the closed cloth: 1 for a disk, 0 for a tube, 2 for a bag without opening.
int euler(const Garment& g) {
    return g.node_count - g.edges.size() + int(g.triangles.size());
}

int edges_with(const Garment& g, int triangles) {
    int count = 0;
    for (int e = 0; e < g.edges.size(); ++e)
        count += g.edges.triangles_at(e) == triangles;
    return count;
}

} // namespace

TEST_CASE("uv is the panel turned until its warp runs along y") {
    Pattern pattern;
    pattern.panels = {rectangle("p", 0.2, 0.1)};
    SECTION("by default the panel's y is the warp") {
        const FlatLevel flat = flat_level(pattern, 0.05);
        const Garment g = sew(pattern, flat);
        CHECK(g.uv == flat.points);
    }
    SECTION("along x, on the bias") {
        for (double grain : {0.0, 0.8, -2.0}) {
            pattern.panels[0].grain = grain;
            const FlatLevel flat = flat_level(pattern, 0.05);
            const Garment g = sew(pattern, flat);
            const Vec2 warp(std::cos(grain), std::sin(grain));
            for (std::size_t v = 0; v < g.uv.size(); ++v) {
                CHECK(g.uv[v].y() == Approx(warp.dot(flat.points[v])).margin(1e-15));
                CHECK(g.uv[v].norm() == Approx(flat.points[v].norm()).margin(1e-15));
            }
            for (std::size_t t = 0; t < g.triangles.size(); ++t) { // turned, not mirrored
                const Mat2& rest = g.rest.edges[t];
                CHECK(rest.determinant() > 0);
                CHECK((rest.col(0) - (g.uv[g.triangles[t][1]] - g.uv[g.triangles[t][0]])).norm() < 1e-15);
                CHECK((rest.col(1) - (g.uv[g.triangles[t][2]] - g.uv[g.triangles[t][0]])).norm() < 1e-15);
            }
        }
    }
}

TEST_CASE("shrunk cloth rests shorter along its warp and weft, and seams to other cloth are eased") {
    Pattern pattern = tube(0.3, 0.4);
    const FlatLevel flat = flat_level(pattern, 0.05);
    for (const double grain : {M_PI / 2, 0.6}) {
        for (Panel& panel : pattern.panels) panel.grain = grain, panel.shrink = {0, 0};
        const Garment cut = sew(pattern, flat);
        pattern.panels[0].shrink = {-0.02, 0.05};
        const Garment g = sew(pattern, flat);
        for (std::size_t t = 0; t < g.triangles.size(); ++t) {
            const bool front = g.panel_of_triangle[t] == 0;
            const Vec2 share = front ? Vec2(1.02, 0.95) : Vec2(1, 1);
            CHECK((g.rest.edges[t] - share.asDiagonal() * cut.rest.edges[t]).norm() < 1e-14);
            CHECK((g.uv[g.triangles[t][1]] - g.uv[g.triangles[t][0]] - g.rest.edges[t].col(0)).norm() < 1e-15);
        }
        CHECK(std::count(cut.eased_triangle.begin(), cut.eased_triangle.end(), true) == 0);
        const bool along = grain != 0.6; // on the bias the seam stays nearly as long
        CHECK((std::count(g.eased_triangle.begin(), g.eased_triangle.end(), true) > 0) == along);
        const std::vector<double> areas = rest_areas(g), nodes = node_areas(g);
        CHECK(std::accumulate(areas.begin(), areas.end(), 0.0) == Approx(0.3 * 0.4 * (1 + 1.02 * 0.95)));
        CHECK(std::accumulate(nodes.begin(), nodes.end(), 0.0) == Approx(0.3 * 0.4 * (1 + 1.02 * 0.95)));
    }
}

TEST_CASE("an open garment has a node per vertex and stitches that stand for the whole seam") {
    Pattern pattern = tube(0.31, 0.4);
    pattern.panels[1].outline = rectangle("back", 0.31, 0.44).outline; // 10 % ease in both seams
    pattern.panels[0].fabric = "denim";
    pattern.fabric = "poplin";
    pattern.panels[1].layer = 2;
    const Garment g = sewn(pattern, 0.03);
    CHECK(g.node_count == int(g.uv.size()));
    CHECK(g.panel_fabrics == std::vector<std::string>{"denim", "poplin"});
    CHECK(g.panel_layers == std::vector<int>{0, 2});
    CHECK(g.edges.size() > 0);
    CHECK(g.rest.angles == std::vector<double>(g.edges.size(), 0.0));
    std::map<int, double> length;
    for (const Stitch& s : g.stitches) {
        CHECK(s.r == 0);
        CHECK(s.a != s.b[0]);
        CHECK(s.length > 0);
        length[s.seam] += s.length;
    }
    CHECK(length.size() == 2);
    for (const auto& [seam, l] : length)
        CHECK(l == Approx(0.42)); // the mean of both sides
    REQUIRE(g.borders.size() == 8);
    CHECK(g.borders[5].panel == 1);
    CHECK(g.borders[5].edge == 1);
    CHECK(g.uv[g.borders[5].vertices.back()] == Vec2(0.31, 0.44));
}

TEST_CASE("seam edges and eased triangles are those at the seams") {
    Pattern pattern = tube(0.3, 0.4);
    const bool uneven = GENERATE(false, true);
    if (uneven) pattern.panels[1].outline = rectangle("back", 0.3, 0.41).outline; // 2.5 %
    const Garment g = sewn(pattern, 0.03);
    for (int e = 0; e < g.edges.size(); ++e) {
        const Vec2 a = g.uv[g.edges.ends[e][0]], b = g.uv[g.edges.ends[e][1]];
        const bool on_side = std::abs(a.x() - b.x()) < 1e-12 && (a.x() < 1e-12 || a.x() > 0.3 - 1e-12);
        CHECK(g.seam_edge[e] == on_side);
    }
    for (std::size_t t = 0; t < g.triangles.size(); ++t) {
        bool touches = false;
        for (int v : g.triangles[t])
            touches = touches || g.uv[v].x() < 1e-12 || g.uv[v].x() > 0.3 - 1e-12;
        CHECK(g.eased_triangle[t] == (uneven && touches));
    }
}

TEST_CASE("closing a tube gives a tube") {
    const Garment open = sewn(tube(0.3, 0.4), 0.03);
    std::vector<int> map;
    const Garment g = close_seams(open, &map);
    CHECK(euler(open) == 2); // two disks
    CHECK(euler(g) == 0);
    CHECK(g.stitches.empty());
    CHECK(edges_with(g, 3) == 0);
    CHECK(count_pieces(node_triangles(g), g.node_count) == 1);
    REQUIRE(map.size() == std::size_t(open.node_count));
    for (const Stitch& s : open.stitches)
        CHECK(map[s.a] == map[s.b[0]]);
    for (std::size_t v = 0; v < open.uv.size(); ++v)
        CHECK(g.node_of_vertex[v] == map[open.node_of_vertex[v]]);
    // Nodes are numbered by their smallest vertex.
    int highest = -1;
    for (int node : g.node_of_vertex) {
        CHECK(node <= highest + 1);
        highest = std::max(highest, node);
    }
    CHECK(highest + 1 == g.node_count);
    // Seam edges stay marked and now lie between two triangles.
    int seams = 0;
    for (int e = 0; e < g.edges.size(); ++e)
        if (g.seam_edge[e]) {
            ++seams;
            CHECK(g.edges.triangles_at(e) == 2);
        }
    CHECK(2 * seams == std::count(open.seam_edge.begin(), open.seam_edge.end(), true));
    // What belongs to the cut cloth has not changed.
    CHECK(g.uv == open.uv);
    CHECK(g.triangles == open.triangles);
    CHECK(g.eased_triangle == open.eased_triangle);
}

TEST_CASE("a tube with a twist is a Moebius band and still closes") {
    Pattern pattern;
    pattern.panels = {rectangle("band", 0.5, 0.1)};
    pattern.seams = {seam("s", {whole(0, 1)}, {whole(0, 3)})}; // bottom to top meets top to bottom
    const Garment g = close_seams(sewn(pattern, 0.03));
    CHECK(euler(g) == 0);
    CHECK(edges_with(g, 3) == 0);
}

TEST_CASE("a dart closes to its tip") {
    Pattern pattern;
    pattern.panels = {
        polygon("skirt", {{0, 0}, {0.3, 0}, {0.3, 0.4}, {0.17, 0.4}, {0.15, 0.28}, {0.13, 0.4}, {0, 0.4}})};
    pattern.seams = {seam("dart", {whole(0, 3)}, {backward(0, 4)})};
    const FlatLevel flat = flat_level(pattern, 0.02);
    const Garment open = sew(pattern, flat), g = close_seams(open);
    const int tip = flat.border[0][3].back();
    CHECK(euler(g) == 1);
    CHECK(edges_with(g, 1) == edges_with(open, 1) - 2 * int(flat.sewn[0].size()));
    // The tip is an inner node now: all edges at it have two triangles.
    for (int e = 0; e < g.edges.size(); ++e)
        if (g.edges.ends[e][0] == g.node_of_vertex[tip] || g.edges.ends[e][1] == g.node_of_vertex[tip])
            CHECK(g.edges.triangles_at(e) == 2);
    double length = 0;
    for (const Stitch& s : open.stitches)
        length += s.length;
    const double leg = std::hypot(0.02, 0.12), last = leg / double(flat.sewn[0].size());
    CHECK(length == Approx(leg - last / 2)); // the tip needs no thread for its half segment
}

TEST_CASE("four panels that meet in a point share one node there") {
    Pattern pattern;
    for (const char* name : {"a", "b", "c", "d"})
        pattern.panels.push_back(rectangle(name, 0.2, 0.2));
    // a b
    // c d
    pattern.seams = {seam("ab", {whole(0, 1)}, {backward(1, 3)}), seam("cd", {whole(2, 1)}, {backward(3, 3)}),
                     seam("ac", {whole(0, 0)}, {backward(2, 2)}),
                     seam("bd", {whole(1, 0)}, {backward(3, 2)})};
    const FlatLevel flat = flat_level(pattern, 0.03);
    const Garment g = close_seams(sew(pattern, flat));
    CHECK(euler(g) == 1);
    const int centre = g.node_of_vertex[flat.border[0][0].back()];
    CHECK(g.node_of_vertex[flat.border[1][0].front()] == centre);
    CHECK(g.node_of_vertex[flat.border[2][2].front()] == centre);
    CHECK(g.node_of_vertex[flat.border[3][2].back()] == centre);
}

TEST_CASE("three layers in one seam share their edges") {
    Pattern pattern;
    pattern.panels = {rectangle("shell", 0.3, 0.2), rectangle("lining", 0.3, 0.2),
                      rectangle("band", 0.3, 0.05)};
    pattern.seams = {seam("s", {whole(0, 2)}, {whole(1, 2)}), seam("t", {whole(0, 2)}, {backward(2, 0)})};
    const FlatLevel flat = flat_level(pattern, 0.02);
    const Garment g = close_seams(sew(pattern, flat));
    CHECK(edges_with(g, 3) == int(flat.sewn[0].size()));
    for (int e = 0; e < g.edges.size(); ++e)
        if (g.edges.triangles_at(e) == 3) CHECK(g.seam_edge[e]);
}

TEST_CASE("coarse tubes and belts close without folding onto themselves") {
    for (const auto& [width, height] : {std::pair(0.08, 0.03), std::pair(0.1, 0.2), std::pair(0.3, 0.04)})
        for (double edge : {0.02, 0.04, 0.08, 0.16}) {
            const Garment g = close_seams(sewn(tube(width, height), edge));
            CAPTURE(width, height, edge);
            CHECK(euler(g) == 0);
            CHECK(edges_with(g, 3) + edges_with(g, 4) == 0);
        }
    // A flat tube sewn along both long edges: chords across both strips would coincide.
    Pattern belt;
    belt.panels = {rectangle("outer", 0.6, 0.03), rectangle("inner", 0.6, 0.03)};
    belt.seams = {seam("above", {whole(0, 2)}, {whole(1, 2)}), seam("below", {whole(0, 0)}, {whole(1, 0)})};
    for (double edge : {0.02, 0.04, 0.08}) {
        const Garment g = close_seams(sewn(belt, edge));
        CHECK(euler(g) == 0);
        CHECK(edges_with(g, 3) + edges_with(g, 4) == 0);
    }
}

TEST_CASE("vertices are found along spans") {
    Pattern pattern = tube(0.3, 0.4);
    pattern.pins = {{{1, 2, 0.75, 0.25}}}; // edge 2 runs from x = 0.3 to x = 0
    const Garment g = sewn(pattern, 0.02);
    const std::vector<int> found = vertices_along(g, pattern.pins[0].span);
    REQUIRE(found.size() > 4);
    CHECK(g.uv[found.front()].isApprox(Vec2(0.075, 0.4)));
    CHECK(g.uv[found.back()].isApprox(Vec2(0.225, 0.4)));
    for (int v : found)
        CHECK(g.panel_of_vertex[v] == 1);
}

TEST_CASE("folds keep their rest angle when seams close") {
    Pattern pattern = tube(0.3, 0.3);
    pattern.panels[0].lines = {{{{{0.1, 0}, {0.1, 0.3}, Straight{}, ""}}, InnerLineKind::fold, 1.2}};
    const FlatLevel flat = flat_level(pattern, 0.03);
    for (const Garment& g : {sew(pattern, flat), close_seams(sew(pattern, flat))})
        CHECK(std::accumulate(g.rest.angles.begin(), g.rest.angles.end(), 0.0) ==
              Approx(1.2 * double(flat.lines[0][0].size() - 1)));
}

TEST_CASE("stitches to the inside of an edge stay, over the new nodes") {
    Garment open = sewn(tube(0.3, 0.3), 0.05);
    const std::array<int, 2> edge = open.edges.ends[open.edges.size() - 1];
    open.stitches.push_back({0, edge, 0.25, 7, 0.01});
    std::vector<int> map;
    const Garment g = close_seams(open, &map);
    REQUIRE(g.stitches.size() == 1);
    CHECK(g.stitches[0].a == map[0]);
    CHECK(g.stitches[0].b == std::array{map[edge[0]], map[edge[1]]});
    CHECK(g.stitches[0].r == 0.25);
}

TEST_CASE("a seam that would collapse a triangle is refused in a sentence") {
    Garment open = sewn(tube(0.3, 0.3), 0.05);
    const Triangle t = open.nodes(0);
    open.stitches.push_back({t[0], {t[1], t[1]}, 0, 0, 0.01});
    CHECK_THROWS_WITH(close_seams(open), Catch::Contains("collapse") && Catch::Contains("'front'"));
}
