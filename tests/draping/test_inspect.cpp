// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/inspect.h"
#include "tests/support/flat_mesh.h"
#include "tests/support/mesh_cloth.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace toile;
using test::Cloth;
using test::cloth_of;

namespace {

Cloth flat_square() {
    const test::FlatMesh mesh = test::jittered_rectangle(0.2, 0.2, 0.02, 0.2, 3);
    return {test::garment_of(mesh), test::flat_points(mesh)};
}

} // namespace

TEST_CASE("inspection of a flat square with a body under it") {
    const Cloth c = flat_square();
    TriMesh body = test::grid(4, 4, 0.1, -0.003);
    for (Vec3& p : body.points)
        p -= Vec3(0.1, 0.1, 0);
    Fabric fabric;
    fabric.limit_warp = 0.01;
    const Inspection i = inspect(c.garment, c.x, body, {fabric});
    CHECK(i.panels == 1);
    CHECK(i.nodes == int(c.x.size()));
    CHECK(i.vertices == i.nodes);
    CHECK(i.triangles == int(c.garment.triangles.size()));
    CHECK(i.not_finite == 0);
    CHECK(i.pieces == 1);
    CHECK(i.border_loops == 1);
    CHECK(i.crowded_edges == 0);
    CHECK(i.turned_edges == 0);
    CHECK(i.flat_triangles == 0);
    CHECK(i.area == Approx(0.04));
    CHECK(i.mean_edge == Approx(0.02).epsilon(0.1));
    CHECK(i.seam_gap_max == 0);
    CHECK(i.intersections.cloth_avatar == 0);
    CHECK(i.intersections.cloth_cloth == 0);
    CHECK(i.has_body);
    CHECK(i.clearance == Approx(0.003));
    CHECK(i.has_pattern);
    CHECK(i.strain.principal.p99 < 1e-12);
    CHECK(i.strain.limit_warp == 0.01);
    CHECK(i.developability.angle_defect_max < 1e-12);
}

TEST_CASE("inspection tells what is wrong with a mesh") {
    const Cloth tube = cloth_of(test::tube(0.2, 0.3, 24, 6));
    CHECK_FALSE(inspect(tube.garment, tube.x, {}).has_pattern);
    CHECK_FALSE(inspect(tube.garment, tube.x, {}).has_body);
    CHECK(inspect(tube.garment, tube.x, {}).border_loops == 2);

    TriMesh mesh = test::grid(3, 3, 0.1);
    std::swap(mesh.triangles[8][0], mesh.triangles[8][1]); // one in the middle, turned over: its three edges
    Cloth c = cloth_of(mesh);
    CHECK(inspect(c.garment, c.x, {}).turned_edges == 3);

    mesh = test::grid(3, 3, 0.1);
    mesh.points.push_back({0.15, 0.15, 0.1});
    mesh.triangles.push_back({5, 6, 16}); // a flap on an inner edge
    c = cloth_of(mesh);
    CHECK(inspect(c.garment, c.x, {}).crowded_edges == 1);
    CHECK(inspect(c.garment, c.x, {}).intersections.cloth_cloth == 0);
    mesh.points[16] = {0.15, 0.15, 0}; // pressed flat onto its neighbours
    c = cloth_of(mesh);
    CHECK(inspect(c.garment, c.x, {}).intersections.cloth_cloth > 0);

    c = flat_square();
    c.x[7][1] = std::numeric_limits<double>::quiet_NaN();
    CHECK(inspect(c.garment, c.x, {}).not_finite == 1);
    CHECK(inspect(c.garment, c.x, {}).pieces == 0);
}

TEST_CASE("nodes that a format has split along a seam count as one") {
    // Two grids side by side that share the line x = 0.3 in place but not in index.
    TriMesh mesh = test::grid(3, 3, 0.1);
    const int shift = int(mesh.points.size());
    const TriMesh right = test::grid(3, 3, 0.1);
    for (const Vec3& p : right.points)
        mesh.points.push_back(p + Vec3(mesh.points[3][0], 0, 0));
    for (const Triangle& t : right.triangles)
        mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    const Cloth c = cloth_of(mesh);
    const Inspection i = inspect(c.garment, c.x, {});
    CHECK(i.joined_nodes == 4);
    CHECK(i.pieces == 1);
    CHECK(i.border_loops == 1);
    CHECK(i.intersections.cloth_cloth == 0);
}

TEST_CASE("crossings are told by place, with their pairs and panels") {
    // Two sheets through a third in the plane z = 0, and a body through the third.
    TriMesh mesh = test::grid(20, 20, 0.01);
    const int flat = int(mesh.triangles.size());
    for (const double x : {0.033, 0.127}) {
        TriMesh upright = test::grid(4, 4, 0.01);
        for (Vec3& p : upright.points) p = Vec3(x, p.x() + 0.08, p.y() - 0.021);
        test::append(mesh, upright);
    }
    Cloth c = cloth_of(mesh);
    c.garment.panel_names = {"flat", "upright"};
    for (int t = flat; t < int(mesh.triangles.size()); ++t) c.garment.panel_of_triangle[t] = 1;
    TriMesh body = test::ellipsoid({0.02, 0.02, 0.02}, 12, 8);
    for (Vec3& p : body.points) p += Vec3(0.081, 0.047, 0.003);
    const Inspection i = inspect(c.garment, c.x, body);
    REQUIRE(i.crossings.size() == 3);
    CHECK(i.crossings[0].with_body);
    CHECK(i.crossings[0].panels == std::vector<int>{0});
    CHECK((i.crossings[0].at - Vec3(0.081, 0.047, 0)).norm() < 0.025);
    CHECK(std::abs(i.crossings[0].at.z()) < 0.01);
    int own = 0;
    for (const Crossing& k : i.crossings) {
        for (const auto& [a, b] : k.pairs) {
            CHECK(a >= 0);
            CHECK(a < (k.with_body ? flat : int(mesh.triangles.size())));
            CHECK(b < (k.with_body ? int(body.triangles.size()) : int(mesh.triangles.size())));
        }
        if (k.with_body) {
            CHECK(int(k.pairs.size()) == i.intersections.cloth_avatar);
            continue;
        }
        own += int(k.pairs.size());
        CHECK(k.panels == std::vector<int>{0, 1});
        CHECK(std::abs(k.at.y() - 0.1) < 0.011);
        CHECK(std::min(std::abs(k.at.x() - 0.033), std::abs(k.at.x() - 0.127)) < 0.011);
    }
    CHECK(own == i.intersections.cloth_cloth);
    CHECK((i.crossings[1].at - i.crossings[2].at).norm() > 0.08);
}

TEST_CASE("nodes in the body are counted, with the deepest and its place") {
    TriMesh mesh = test::grid(10, 10, 0.01);
    for (Vec3& p : mesh.points) p -= Vec3(0.05, 0.05, 0);
    const Cloth c = cloth_of(mesh);
    TriMesh body = test::ellipsoid({0.03, 0.03, 0.03}, 40, 30);
    for (Vec3& p : body.points) p.z() -= 0.02;
    const Inspection i = inspect(c.garment, c.x, body);
    REQUIRE(i.inside.known);
    int within = 0; // of the circle in which the sphere cuts the plane, whose radius is sqrt(5) cm
    for (const Vec3& p : mesh.points) within += p.norm() < 0.0222;
    CHECK(i.inside.nodes == within);
    CHECK(i.inside.depth == Approx(0.01).epsilon(0.02));
    CHECK(i.inside.at.norm() < 1e-12);
    CHECK(i.inside.panel == 0);

    for (Triangle& t : body.triangles) std::swap(t[0], t[1]); // inside out
    CHECK(inspect(c.garment, c.x, body).inside.nodes == within);
    body.triangles.pop_back();
    CHECK_FALSE(inspect(c.garment, c.x, body).inside.known);
    CHECK_FALSE(inspect(c.garment, c.x, {}).inside.known);
}

TEST_CASE("open seams are told run by run, the widest first") {
    // Two strips side by side, sewn along their facing borders in two runs with a stretch between that is not.
    TriMesh mesh = test::grid(2, 10, 0.01);
    const int second = int(mesh.points.size());
    TriMesh right = test::grid(2, 10, 0.01);
    for (Vec3& p : right.points) p.x() += 0.025;
    test::append(mesh, right);
    Cloth c = cloth_of(mesh);
    c.garment.panel_names = {"left", "right"};
    for (int v = second; v < int(mesh.points.size()); ++v) c.garment.panel_of_vertex[v] = 1;
    for (const int j : {0, 1, 2, 3, 6, 7, 8, 9, 10}) {
        const int a = 3 * j + 2, b = second + 3 * j;
        c.garment.stitches.push_back({a, {b, b}, 0, 0, 0.01});
    }
    c.x[second + 3 * 8] = c.x[3 * 8 + 2]; // one of them closed
    c.x[second + 3 * 2].x() += 0.004;
    const Inspection i = inspect(c.garment, c.x, {});
    REQUIRE(i.gaps.size() == 2);
    CHECK(i.gaps[0].stitches == 4);
    CHECK(i.gaps[0].open == 4);
    CHECK(i.gaps[0].gap == Approx(0.009));
    CHECK((i.gaps[0].at - Vec3(0.0245, 0.02, 0)).norm() < 1e-12);
    CHECK(i.gaps[0].panels == std::array<int, 2>{0, 1});
    CHECK(i.gaps[1].stitches == 5);
    CHECK(i.gaps[1].open == 4);
    CHECK(i.gaps[1].gap == Approx(0.005));
    CHECK(i.seam_gap_max == i.gaps[0].gap);
}

TEST_CASE("triangles keep their numbers when a mesh has some without length") {
    TriMesh mesh = test::grid(4, 4, 0.01);
    mesh.points.push_back(mesh.points[0]);
    mesh.triangles.insert(mesh.triangles.begin(), {0, 1, int(mesh.points.size()) - 1}); // two corners at one place
    TriMesh upright = test::grid(2, 2, 0.01);
    for (Vec3& p : upright.points) p = Vec3(0.0171, p.x() + 0.0093, p.y() - 0.0112);
    const int first = int(mesh.triangles.size());
    test::append(mesh, upright);
    const Cloth c = cloth_of(mesh);
    const Inspection i = inspect(c.garment, c.x, {});
    REQUIRE(i.crossings.size() == 1);
    for (const auto& [a, b] : i.crossings[0].pairs) {
        CHECK(a > 0);
        CHECK(a < first);
        CHECK(b >= first);
    }
}
