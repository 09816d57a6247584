// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fit/moving_flat.h"
#include "patterns/curve.h"

#include <catch2/catch.hpp>

using namespace toile;

namespace {

Pattern rectangle() {
    Panel panel;
    panel.name = "cloth";
    panel.outline = {{{0, 0}, {0.4, 0}, Straight{}, ""},
                     {{0.4, 0}, {0.4, 0.3}, Quadratic{{0.45, 0.15}}, ""},
                     {{0.4, 0.3}, {0, 0.3}, Straight{}, ""},
                     {{0, 0.3}, {0, 0}, Straight{}, ""}};
    Pattern pattern;
    pattern.panels = {panel};
    return pattern;
}

/// The upper side goes up and sideways, which shears and stretches the whole.
std::vector<Alteration> shear() {
    return {{"shear", {{{0, 2, 0}, {0.5, 1}}, {{0, 3, 0}, {0.5, 1}}}, -1, 1}};
}

MovingFlat moving(Pattern pattern) {
    TriangulateOptions options;
    options.edge_length = 0.03;
    options.levels = 2;
    FlatPattern flat = triangulate(pattern, options);
    return moving_flat(std::move(pattern), std::move(flat), shear());
}

Eigen::VectorXd amount(double a) { return Eigen::VectorXd::Constant(1, a); }

} // namespace

TEST_CASE("cloth follows its outline: nothing at nothing, and exactly where the outline moves as one") {
    Pattern straight = rectangle();
    straight.panels[0].outline[1].curve = Straight{};
    const MovingFlat m = moving(straight);
    for (int level = 0; level < 2; ++level) {
        const FlatLevel& flat = m.flat.levels[level];
        CHECK(moved_points(m, altered(m.drawn, m.alterations, amount(0)), level) == flat.points);
        const std::vector<Vec2> points = moved_points(m, altered(m.drawn, m.alterations, amount(0.1)), level);
        for (std::size_t v = 0; v < points.size(); ++v) {
            const double up = 0.1 * flat.points[v].y() / 0.3;
            CHECK((points[v] - flat.points[v] - Vec2(0.5 * up, up)).norm() < 1e-12);
        }
        CHECK(collapsed_triangle(m, points, level, 0.1) == -1);
    }
}

TEST_CASE("borders stay on altered curves, and cloth that folds over is found") {
    const MovingFlat m = moving(rectangle());
    const Pattern now = altered(m.drawn, m.alterations, amount(0.05));
    const FlatPattern flat = moved_flat(m, now);
    const Edge& edge = now.panels[0].outline[1];
    const FlatLevel& level = flat.levels[1];
    const std::vector<int>& line = level.border[0][1];
    REQUIRE(line.size() > 5);
    const std::vector<Vec2> on_curve = points_at(edge, level.border_at[0][1]);
    for (std::size_t k = 0; k < line.size(); ++k) CHECK((level.points[line[k]] - on_curve[k]).norm() < 1e-15);
    CHECK((level.points[line.back()] - edge.end).norm() < 1e-15);
    const std::vector<Vec2> over = moved_points(m, altered(m.drawn, m.alterations, amount(-0.4)), 1);
    CHECK(collapsed_triangle(m, over, 1, 0.1) >= 0);
}

TEST_CASE("holes stay where the file has them") {
    Pattern pattern = rectangle();
    const Vec2 a(0.15, 0.1), b(0.25, 0.1), c(0.2, 0.2);
    pattern.panels[0].holes = {{{a, c, Straight{}, ""}, {c, b, Straight{}, ""}, {b, a, Straight{}, ""}}};
    const MovingFlat m = moving(pattern);
    const std::vector<Vec2> points = moved_points(m, altered(m.drawn, m.alterations, amount(0.05)), 1);
    int there = 0;
    for (const Vec2& p : points)
        for (const Vec2& corner : {a, b, c}) there += p == corner;
    CHECK(there == 3);
}
