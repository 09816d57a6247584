// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/slice.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

using namespace toile;

TEST_CASE("a box is cut in one rectangle", "[slice]") {
    const TriMesh box = test::box(Vec3(-1, 0, -2), Vec3(1, 2, 2));
    const auto loops = slice(box, 0.7);
    REQUIRE(loops.size() == 1);
    CHECK(loop_area(loops[0]).area == Approx(8));
    CHECK(loop_area(loops[0]).centroid.norm() < 1e-12);
    CHECK(hull_length(loops[0]) == Approx(12));
    CHECK(convex_hull(loops[0]).size() == 4);
}

TEST_CASE("a cut through points and edges is as closed as any other", "[slice]") {
    const TriMesh ball = test::sphere(1, 4);
    const auto loops = slice(ball, 0); // many points lie at exactly 0
    REQUIRE(loops.size() == 1);
    CHECK(hull_length(loops[0]) == Approx(2 * EIGEN_PI).epsilon(0.01));
    CHECK(slice(ball, 1.5).empty());
}

TEST_CASE("two bodies are cut in two loops", "[slice]") {
    TriMesh mesh = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
    const TriMesh other = test::box(Vec3(0.5, 0, 0), Vec3(3, 1, 1)); // they cross, and stay two
    for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
    mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
    const auto loops = slice(mesh, 0.5);
    REQUIRE(loops.size() == 2);
    CHECK(loop_area(loops[0]).area + loop_area(loops[1]).area == Approx(3.5));
}

TEST_CASE("a tape measure spans hollows", "[slice]") {
    const std::vector<Vec2> crescent{{0, 0}, {4, 0}, {4, 3}, {2, 1}, {0, 3}, {0, 1}, {4, 0}, {2, 0}};
    CHECK(hull_length(crescent) == Approx(14));
    CHECK(hull_length({}) == 0);
    CHECK(hull_length({{1, 1}}) == 0);
    CHECK(hull_length({{0, 0}, {3, 4}}) == Approx(10));
}
