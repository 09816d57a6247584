// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/place.h"

#include "geometry/distance.h"
#include "geometry/intersections.h"
#include "tests/support/sewn_squares.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>

using namespace toile;
using namespace toile::test;

namespace {

TriMesh panel_mesh(const Cloth& c, const Points& x, int panel) {
    TriMesh m{x, {}};
    for (int t = 0; t < int(c.garment.triangles.size()); ++t)
        if (c.garment.panel_of_triangle[t] == panel) m.triangles.push_back(c.garment.nodes(t));
    return m;
}

/// Every triangle against every other, without a tree; 0 where they cross.
double distance_between(const TriMesh& a, const TriMesh& b) {
    if (!intersecting_pairs(a, b).empty()) return 0;
    double least = std::numeric_limits<double>::infinity();
    const auto corner = [](const TriMesh& m, const Triangle& t, int k) { return m.points[t[k % 3]]; };
    for (const Triangle& s : a.triangles)
        for (const Triangle& t : b.triangles)
            for (int i = 0; i < 3; ++i) {
                least = std::min(least, nearest_point_triangle(corner(a, s, i), corner(b, t, 0),
                                                               corner(b, t, 1), corner(b, t, 2))
                                            .squared);
                least = std::min(least, nearest_point_triangle(corner(b, t, i), corner(a, s, 0),
                                                               corner(a, s, 1), corner(a, s, 2))
                                            .squared);
                for (int j = 0; j < 3; ++j)
                    least = std::min(least, nearest_edge_edge(corner(a, s, i), corner(a, s, i + 1),
                                                              corner(b, t, j), corner(b, t, j + 1))
                                                .squared);
            }
    return std::sqrt(least);
}

Vec3 push_of(const PlacedClear& placed, int panel) {
    for (const PanelPush& p : placed.pushed)
        if (p.panel == panel) return p.push;
    return Vec3::Zero();
}

} // namespace

TEST_CASE("panels that are clear stay where they are") {
    Cloth c;
    add_front(c, {0, 0, 0.106});
    add_front(c, {0, 0, 0.109});
    const PlacedClear placed = place_clear(c.garment, c.x, sphere(0.1, 4));
    CHECK(placed.pushed.empty());
    CHECK(placed.left.empty());
    CHECK(placed.x == c.x);
}

TEST_CASE("a panel through a body is pushed out of it by no more than it takes") {
    const TriMesh body = sphere(0.1, 4);
    for (const double depth : {-0.003, 0.004, 0.05}) {
        Cloth c;
        add_front(c, {0, 0, 0.1 - depth});
        const PlacedClear placed = place_clear(c.garment, c.x, body);
        REQUIRE(placed.pushed.size() == 1);
        CHECK(placed.pushed[0].from_body);
        const Vec3 push = placed.pushed[0].push;
        CHECK(push.head<2>().norm() < 1e-12);
        CHECK(push.z() > depth + 0.005 - 1e-3); // a sphere of flat triangles is a little smaller
        CHECK(push.z() < depth + 0.005 + 2e-3);
        CHECK(distance_between(panel_mesh(c, placed.x, 0), body) >= 0.005);
    }
}

TEST_CASE("a panel that lies inside a body without crossing it is pushed out") {
    Cloth c;
    add_front(c, {0, 0, 0.3});
    const TriMesh body = box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
    const PlacedClear placed = place_clear(c.garment, c.x, body);
    CHECK(push_of(placed, 0).z() > 0.205 - 1e-9);
    CHECK(push_of(placed, 0).z() < 0.207 + 1e-9);
}

TEST_CASE("two panels in one place are separated") {
    Cloth c;
    add_front(c, {0, 0, 0.2});
    add_front(c, {0.013, 0.007, 0.2});
    const PlacedClear placed = place_clear(c.garment, c.x, sphere(0.1, 3));
    REQUIRE(placed.pushed.size() == 1);
    CHECK_FALSE(placed.pushed[0].from_body);
    CHECK(placed.pushed[0].push.z() == Approx(0.002));
    CHECK(distance_between(panel_mesh(c, placed.x, 0), panel_mesh(c, placed.x, 1)) >= 0.002 - 1e-12);
}

TEST_CASE("crossing panels are separated, from the body too") {
    Cloth c;
    add_front(c, {0, 0, 0.09});
    add_panel(c, {0, 0, 0.1}, Vec3::UnitX(), Vec3(0, 0.8, 0.6)); // cuts the first and the body
    const TriMesh body = sphere(0.1, 4);
    const PlacedClear placed = place_clear(c.garment, c.x, body);
    CHECK(placed.left.empty());
    CHECK(distance_between(panel_mesh(c, placed.x, 0), panel_mesh(c, placed.x, 1)) >= 0.002 - 1e-12);
    for (int panel : {0, 1})
        CHECK(distance_between(panel_mesh(c, placed.x, panel), body) >= 0.005 - 1e-12);
}

TEST_CASE("panels that a seam joins at no distance may touch there") {
    Cloth c;
    add_front(c, {-0.1, 0, 0.2});
    add_front(c, {0.1, 0, 0.2});
    const auto touching = [&] { return place_clear(c.garment, c.x, sphere(0.1, 3)); };
    CHECK(touching().pushed.size() == 1);
    for (int j = 0; j <= 10; ++j) {
        const int a = 11 * j + 10, b = 121 + 11 * j;
        c.garment.stitches.push_back({a, {b, b}, 0, 0, 0.02});
    }
    CHECK(touching().pushed.empty());
    c.garment.stitches.erase(c.garment.stitches.begin() + 4, c.garment.stitches.begin() + 7);
    CHECK(touching().pushed.size() == 1); // where no stitch is they may not
}

TEST_CASE("the lower layer is placed first and the upper one keeps off it") {
    Cloth c;
    add_front(c, {0, 0, 0.104}, 1);
    add_front(c, {0, 0, 0.094}, 0);
    const PlacedClear placed = place_clear(c.garment, c.x, sphere(0.1, 4));
    const double lower = placed.x[121].z(), upper = placed.x[0].z();
    CHECK(lower < 0.108);
    CHECK(upper >= lower + 0.002 - 1e-12);
}

TEST_CASE("a panel that is to lie outside goes beyond the threads of the others") {
    Cloth c;
    add_front(c, {0.1, 0, 0.15});
    add_front(c, {0, 0, 0.2});
    add_back(c, {0, 0, -0.2});
    sew_sides(c, 1, 2); // its threads pass through the first panel
    const TriMesh body = sphere(0.05, 3);
    CHECK(place_clear(c.garment, c.x, body).pushed.empty());
    PlaceOptions o;
    o.outside = {true, false, false};
    const PlacedClear placed = place_clear(c.garment, c.x, body, o);
    REQUIRE(placed.pushed.size() == 1);
    CHECK(push_of(placed, 0).z() > 0.05);
    CHECK(push_of(placed, 0).z() < 0.06);
}

TEST_CASE("fixed panels stay, others keep off them, and a panel that no push clears stays too and is named") {
    Cloth c;
    add_front(c, {0, 0, 0.2});
    add_front(c, {0, 0, 0.2});
    PlaceOptions o;
    o.fixed = {false, true};
    const PlacedClear placed = place_clear(c.garment, c.x, sphere(0.1, 3), o);
    CHECK(push_of(placed, 0).norm() > 0);
    CHECK(push_of(placed, 1).norm() == 0);
    o.farthest = 0.001;
    const PlacedClear left = place_clear(c.garment, c.x, sphere(0.1, 3), o);
    CHECK(left.left == std::vector<int>{0});
    CHECK(left.x == c.x);
}

TEST_CASE("panels that share nodes are pushed as one") {
    Cloth c;
    add_front(c, {-0.1, 0, 0.09});
    add_front(c, {0.1, 0, 0.09});
    for (int j = 0; j <= 10; ++j)
        c.garment.node_of_vertex[121 + 11 * j] = 11 * j + 10;
    c.garment.edges = make_edges(node_triangles(c.garment), c.garment.node_count);
    const PlacedClear placed = place_clear(c.garment, c.x, sphere(0.1, 4));
    REQUIRE(placed.pushed.size() == 2);
    CHECK(push_of(placed, 0) == push_of(placed, 1));
}

TEST_CASE("a seam is not moved through the body to the other side of it") {
    // A ball in the way of a long seam, and a smaller one under a short seam. 6 cm down both seams are free, the short one below
    // its ball; 3 cm down the long one is.
    TriMesh body = sphere(0.02, 3);
    const int points = int(body.points.size());
    for (int i = 0; i < points; ++i) body.points.push_back(body.points[i] + Vec3(0, -0.07, 0));
    for (const Triangle& t : std::vector<Triangle>(body.triangles)) body.triangles.push_back({t[0] + points, t[1] + points, t[2] + points});
    Cloth c;
    for (const double z : {0.2, -0.2}) add_front(c, {0, -0.01, z});
    const auto sew = [&](int row, double length) {
        const int a = 11 * row + 5;
        c.garment.stitches.push_back({a, {a + 121, a + 121}, 0, 0, length});
    };
    sew(0, 1); // at -11 cm, free
    sew(2, 1); // at -7 cm, in the way
    sew(7, 0.5); // at 3 cm, free
    CHECK(free_height(c.garment, c.x, body) == Approx(-0.03));
    c.garment.stitches.pop_back();
    CHECK(free_height(c.garment, c.x, body) == Approx(-0.03));
}

TEST_CASE("the least move of a garment that frees some of its stitches") {
    const TriMesh body = sphere(0.05, 3);
    Cloth c;
    for (const double z : {0.2, -0.2}) add_front(c, {0, 0, z});
    for (const int row : {3, 7, 10}) { // at -4, 4 and 10 cm
        const int a = 11 * row + 5;
        c.garment.stitches.push_back({a, {a + 121, a + 121}, 0, 0, 0.02});
    }
    const std::vector<char> through = stitches_through_body(c.garment, c.x, body);
    CHECK(through[0]);
    CHECK(through[1]);
    CHECK_FALSE(through[2]);
    const auto lowest = height_free_for(c.garment, c.x, body, {1, 0, 0}), upper = height_free_for(c.garment, c.x, body, {0, 1, 0});
    REQUIRE(lowest);
    REQUIRE(upper);
    CHECK(*lowest == Approx(-0.01).margin(1e-9));
    CHECK(*upper == Approx(0.01).margin(1e-9));
    CHECK(height_free_for(c.garment, c.x, body, {0, 0, 0}) == 0.0);
    CHECK_FALSE(height_free_for(c.garment, c.x, box({-0.1, -1, -0.1}, {0.1, 1, 0.1}), {0, 1, 0}));
}

TEST_CASE("a garment moves up as a whole where its seams can close over the body, and only there") {
    // Front and back that end 3 cm below the top of a ball and are to be sewn together there.
    const auto height_of = [](double top) {
        Cloth c;
        add_front(c, {0, top - 0.1, 0.2});
        add_front(c, {0, top - 0.1, -0.2});
        for (int i = 0; i <= 10; ++i)
            c.garment.stitches.push_back({110 + i, {231 + i, 231 + i}, 0, 0, 0.02});
        return free_height(c.garment, c.x, sphere(0.1, 4));
    };
    CHECK(height_of(0.065) == Approx(0.04));
    CHECK(height_of(0.12) == 0);
    CHECK(height_of(-0.065) == Approx(-0.04));
    Cloth unsewn;
    add_front(unsewn, {0, 0, 0});
    CHECK(free_height(unsewn.garment, unsewn.x, sphere(0.1, 4)) == 0);
}
