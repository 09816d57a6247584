// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/solid.h"
#include "tests/support/shapes.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <algorithm>

using namespace toile;

namespace {

TriMesh unit_box() { return test::box(Vec3(0, 0, 0), Vec3(1, 2, 3)); }

/// Every triangle with three points of its own, as STL has it.
TriMesh apart(const TriMesh& mesh) {
    TriMesh result;
    for (const Triangle& t : mesh.triangles) {
        const int first = int(result.points.size());
        for (int corner : t) result.points.push_back(mesh.points[corner]);
        result.triangles.push_back({first, first + 1, first + 2});
    }
    return result;
}

} // namespace

TEST_CASE("a box is a solid", "[solid]") {
    const TriMesh box = unit_box();
    CHECK(volume(box) == Approx(6));
    CHECK(border_loops(box).empty());
    CHECK(crowded_edges(box) == 0);
}

TEST_CASE("corners that were split are joined again", "[solid]") {
    TriMesh mesh = apart(unit_box());
    CHECK(mesh.points.size() == 36);
    CHECK_FALSE(border_loops(mesh).empty());
    CHECK(join_equal_points(mesh) == 28);
    CHECK(drop_unused_points(mesh) == 28);
    CHECK(mesh.points.size() == 8);
    CHECK(border_loops(mesh).empty());
    CHECK(volume(mesh) == Approx(6));
}

TEST_CASE("two closed parts that touch in a point stay two", "[solid]") {
    TriMesh mesh = unit_box();
    const TriMesh other = test::box(Vec3(1, 2, 3), Vec3(2, 3, 4));
    for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
    mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
    CHECK(join_equal_points(mesh) == 0);
    CHECK(mesh.points.size() == 16);
}

TEST_CASE("an edge without length is joined and its triangles go", "[solid]") {
    TriMesh mesh = unit_box();
    // Split corner 7 into two points in one place, with the two needles between them and corners 3 and 5.
    mesh.points.push_back(mesh.points[7]);
    for (Triangle& t : mesh.triangles)
        if (t == Triangle{1, 3, 7} || t == Triangle{1, 7, 5}) std::replace(t.begin(), t.end(), 7, 8);
    mesh.triangles.push_back({3, 7, 8});
    mesh.triangles.push_back({5, 8, 7});
    REQUIRE(border_loops(mesh).empty());
    CHECK(join_equal_points(mesh) == 1);
    CHECK(mesh.triangles.size() == 12);
    CHECK(border_loops(mesh).empty());
}

TEST_CASE("a flat triangle across three points of a line gives way to its neighbour", "[solid]") {
    TriMesh mesh = unit_box();
    // A point on the edge 0 - 1, used by the bottom face alone: the flat triangle (0, 8, 1) closes the crack.
    mesh.points.push_back(Vec3(0.5, 0, 0));
    mesh.triangles.erase(std::find(mesh.triangles.begin(), mesh.triangles.end(), Triangle{0, 1, 5}));
    mesh.triangles.push_back({0, 8, 5});
    mesh.triangles.push_back({8, 1, 5});
    mesh.triangles.push_back({0, 1, 8});
    REQUIRE(border_loops(mesh).empty());
    CHECK(drop_flat_triangles(mesh) == 1);
    CHECK(border_loops(mesh).empty());
    CHECK(volume(mesh) == Approx(6));
    for (const Triangle& t : mesh.triangles) {
        const Vec3 a = mesh.points[t[1]] - mesh.points[t[0]], b = mesh.points[t[2]] - mesh.points[t[0]];
        CHECK(a.cross(b).norm() > 0.1);
    }
}

TEST_CASE("triangles are turned to face outward", "[solid]") {
    TriMesh mesh = unit_box();
    std::swap(mesh.triangles[2][0], mesh.triangles[2][1]);
    std::swap(mesh.triangles[7][0], mesh.triangles[7][1]);
    CHECK(orient_outward(mesh) == 2);
    CHECK(volume(mesh) == Approx(6));
    for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
    CHECK(volume(mesh) == Approx(-6));
    CHECK(orient_outward(mesh) == 12);
    CHECK(volume(mesh) == Approx(6));
}

TEST_CASE("holes are found one by one and filled", "[solid]") {
    TriMesh mesh = test::sphere(1, 3);
    const double whole = volume(mesh);
    // Everything above one plane and below another goes: two rings.
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
        const double y = (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]]).y() / 3;
        return y > 0.8 || y < -0.9;
    });
    const auto loops = border_loops(mesh);
    REQUIRE(loops.size() == 2);
    for (const auto& loop : loops) {
        const auto fill = fill_loop(mesh.points, loop);
        CHECK(fill.size() == loop.size() - 2);
        mesh.triangles.insert(mesh.triangles.end(), fill.begin(), fill.end());
    }
    CHECK(border_loops(mesh).empty());
    CHECK(orient_outward(mesh) == 0); // the fill already faces outward
    CHECK(volume(mesh) < whole);
    CHECK(volume(mesh) > 0.9 * whole);
}

TEST_CASE("two holes that touch in a point are two loops", "[solid]") {
    TriMesh mesh = test::sphere(1, 2);
    // The triangles around one point, but for two opposite ones, leave a figure of eight.
    const int centre = 4;
    int keep = 0;
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
        if (std::count(t.begin(), t.end(), centre) == 0) return false;
        return keep++ % 2 == 0;
    });
    const auto loops = border_loops(mesh);
    CHECK(loops.size() == 2);
    for (const auto& loop : loops) CHECK(loop.size() == 3);
}

TEST_CASE("a loop of four is filled along its shorter diagonal", "[solid]") {
    const Points kite{{0, 0, 0}, {2, -0.5, 0.3}, {4, 0, 0}, {2, 0.5, 0.3}};
    const auto fill = fill_loop(kite, {0, 1, 2, 3});
    REQUIRE(fill.size() == 2);
    double area = 0;
    for (const Triangle& t : fill)
        area += 0.5 * (kite[t[1]] - kite[t[0]]).cross(kite[t[2]] - kite[t[0]]).norm();
    CHECK(area < 2.03); // across the ridge 1 - 3; along 0 - 2 it would be 2.33
}
