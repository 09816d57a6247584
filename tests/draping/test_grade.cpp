// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/grade.h"
#include "tests/support/skirt.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace toile;

TEST_CASE("the curvature of a tube is one over its radius, about") {
    const auto tube = test::make_skirt(24, 12, 0.16, 1.0, 0.5);
    const std::vector<double> k = node_curvature(tube.garment, tube.x);
    for (const double curvature : k) {
        CHECK(curvature > 0.4 / 0.16); // edges along it show none
        CHECK(curvature < 1.2 / 0.16);
    }
}

TEST_CASE("cloth that is curved alike everywhere has one edge length") {
    const auto tube = test::make_skirt(24, 12, 0.16, 1.0, 0.5);
    for (const double h : graded_edges(tube.garment, tube.x, {0.02, 0.04, 0.5})) {
        CHECK(h >= 0.02);
        CHECK(h < 0.03);
    }
}

TEST_CASE("edges are fine at a fold and coarse where cloth is flat and change slowly between") {
    auto sheet = test::make_skirt(24, 24, 0.16, 1.0, 0.5);
    // Flattened to a folded band: two planes that meet at its sides.
    for (Vec3& p : sheet.x) p.z() *= 0.05;
    const GradeOptions o{0.01, 0.04, 0.1};
    const std::vector<double> h = graded_edges(sheet.garment, sheet.x, o);
    double at_fold = 1, on_plane = 0;
    for (std::size_t i = 0; i < h.size(); ++i) {
        if (std::abs(sheet.x[i].x()) > 0.158) at_fold = std::min(at_fold, h[i]);
        if (std::abs(sheet.x[i].x()) < 0.02) on_plane = std::max(on_plane, h[i]);
    }
    CHECK(at_fold == Approx(0.01));
    CHECK(on_plane > 0.03);
    for (const auto& [a, b] : sheet.garment.edges.ends)
        CHECK(std::abs(h[a] - h[b]) <= 0.5 * (sheet.x[a] - sheet.x[b]).norm() * (1 + 1e-6));
}

TEST_CASE("values at nodes are found again at their places in the panels") {
    const auto tube = test::make_skirt(12, 8, 0.16, 1.0, 0.5);
    std::vector<double> height;
    for (const Vec3& p : tube.x) height.push_back(p.y());
    const auto at = over_panels(tube.garment, height);
    for (std::size_t v = 0; v < tube.garment.uv.size(); ++v)
        CHECK(at(tube.garment.panel_of_vertex[v], tube.garment.uv[v]) == Approx(height[tube.garment.node_of_vertex[v]]));
}
