// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/alter.h"
#include "patterns/check.h"
#include "patterns/curve.h"
#include "patterns/shrink.h"

#include <catch2/catch.hpp>

using namespace toile;

namespace {

/// A square of 1 m, counter-clockwise, its right side a quadratic, its top a cubic and its left an arc.
Panel square(double x = 0) {
    Panel p;
    p.name = "square";
    const Vec2 a(x, 0), b(x + 1, 0), c(x + 1, 1), d(x, 1);
    p.outline = {{a, b, Straight{}, ""},
                 {b, c, Quadratic{{x + 1.2, 0.5}}, ""},
                 {c, d, Cubic{{x + 0.8, 1.1}, {x + 0.2, 1.2}}, ""},
                 {d, a, Arc{0.8, false, true}, ""}};
    return p;
}

Pattern two_squares() {
    Pattern pattern;
    pattern.panels = {square(), square(2)};
    Seam seam;
    seam.a = {{0, 1, 0, 1}};
    seam.b = {{1, 3, 1, 0}};
    pattern.seams = {seam};
    return pattern;
}

Pattern by(const Pattern& pattern, std::vector<OutlineMove> moves, double amount) {
    return altered(pattern, {{"one", std::move(moves), -1, 1}}, Eigen::VectorXd::Constant(1, amount));
}

} // namespace

TEST_CASE("an alteration by nothing leaves every number as it is") {
    const Pattern pattern = two_squares(), same = by(pattern, move_seam(pattern, 0), 0);
    for (int e = 0; e < 4; ++e) {
        CHECK(same.panels[0].outline[e].start == pattern.panels[0].outline[e].start);
        CHECK(point_at(same.panels[0].outline[e], 0.3) == point_at(pattern.panels[0].outline[e], 0.3));
    }
}

TEST_CASE("a vertex takes both its edges along, and their curves keep their places along the chord") {
    const Pattern pattern = two_squares();
    // The upper right corner goes up by as much as the right side is long: that becomes twice as large all over.
    const Pattern p = by(pattern, {{{0, 2, 0}, {0, 1}}}, 1);
    const Loop& now = p.panels[0].outline;
    CHECK((now[1].end - Vec2(1, 2)).norm() < 1e-15);
    CHECK((now[2].start - Vec2(1, 2)).norm() < 1e-15);
    CHECK((std::get<Quadratic>(now[1].curve).control - Vec2(1.4, 1)).norm() < 1e-14);
    CHECK(length(now[1]) == Approx(2 * length(pattern.panels[0].outline[1])));
    CHECK(now[3].start == pattern.panels[0].outline[3].start);
    // An arc keeps its angle.
    const Pattern q = by(pattern, {{{0, 0, 0}, {0, -1}}}, 1);
    CHECK(length(q.panels[0].outline[3]) == Approx(2 * length(pattern.panels[0].outline[3])));
}

TEST_CASE("what a cutter alters: lengths, darts, controls and the place of a seam") {
    const Pattern pattern = two_squares();
    CHECK(length(by(pattern, lengthen_edge(pattern, 0, 0), 0.1).panels[0].outline[0]) == Approx(1.1));

    const Pattern moved = by(pattern, move_seam(pattern, 0), 0.05);
    CHECK((moved.panels[0].outline[1].start - Vec2(1.05, 0)).norm() < 1e-15);
    CHECK((moved.panels[1].outline[3].end - Vec2(2.05, 0)).norm() < 1e-15); // the other panel loses it
    CHECK(seam_lengths(moved, moved.seams[0]).a == Approx(seam_lengths(pattern, pattern.seams[0]).a));

    const auto dart = widen_dart(pattern, 0, 0); // edges 0 and 1, its tip in the lower right corner
    const Pattern wide = by(pattern, dart, 0.02);
    const auto mouth = [](const Pattern& p) { return (p.panels[0].outline[1].end - p.panels[0].outline[0].start).norm(); };
    CHECK(mouth(wide) == Approx(mouth(pattern) + 0.02));

    const Pattern bent = by(pattern, {{{0, 2, 2}, {0, 1}}}, 0.1);
    CHECK(std::get<Cubic>(bent.panels[0].outline[2].curve).control1.y() == Approx(1.3));
    CHECK(bent.panels[0].outline[2].start == pattern.panels[0].outline[2].start);
}

TEST_CASE("rest lengths alter: a band grows by metres together, and cloth shrinks by shares") {
    Pattern pattern = two_squares();
    pattern.panels[1].shrink = {0.5, 0};
    pattern.elastics = {{{0, 0, 0, 1}, 0.8, 50}, {{1, 0, 0.25, 0.75}, 0.6, 50}}; // on 1 m and on a quarter
    Alteration band{"band", {}, -1, 1, lengthen_elastics(pattern, {0, 1})};
    Alteration steam{"steam", {}, -1, 1};
    steam.shrinks = {{0, {0, 1}}, {1, {-0.5, 0}}};
    const auto relaxed = [](const Pattern& p) {
        double sum = 0;
        for (const Elastic& e : p.elastics) sum += e.ratio * length_at_rest(p, e.span);
        return sum;
    };
    Pattern now = altered(pattern, {band, steam}, Eigen::Vector2d(-0.1, 0));
    CHECK(relaxed(now) == Approx(relaxed(pattern) - 0.1));
    CHECK(now.elastics[0].ratio == Approx(0.8 - 0.08));
    CHECK(now.elastics[1].ratio == Approx(0.6 - 0.08));
    CHECK(now.panels[0].shrink == Vec2(0, 0));
    now = altered(pattern, {band, steam}, Eigen::Vector2d(0, 0.03));
    CHECK(now.panels[0].shrink == Vec2(0, 0.03));
    CHECK(now.panels[1].shrink.x() == Approx(0.485));
    CHECK(now.elastics[0].ratio == 0.8);
    // Bounds are reached, whatever rounding says.
    CHECK(altered(pattern, {band, steam}, Eigen::Vector2d(1.25 * (1 - 0.8), 0)).elastics[0].ratio == 1);
    CHECK_THROWS_WITH(altered(pattern, {{"x", {}, 0, 1, {{2, 1}}}}, Eigen::VectorXd::Zero(1)), "there is no elastic 2");
    CHECK_THROWS_WITH(lengthen_elastics(pattern, {}), "an elastic on cloth of no length cannot be altered");
}

TEST_CASE("an alteration outside of the pattern is refused in a sentence") {
    const Pattern pattern = two_squares();
    CHECK_THROWS_WITH(lengthen_edge(pattern, 0, 4), "there is no edge 4 of panel square");
    CHECK_THROWS_WITH(lengthen_edge(pattern, 2, 0), "there is no panel 2");
    CHECK_THROWS_WITH(move_seam(pattern, 1), "there is no seam 1");
    CHECK_THROWS_WITH(by(pattern, {{{0, 0, 1}, {0, 1}}}, 0.1), "edge 0 of panel square has no control point 1");
    CHECK_THROWS_AS(altered(pattern, {}, Eigen::VectorXd::Zero(1)), std::invalid_argument);
}
