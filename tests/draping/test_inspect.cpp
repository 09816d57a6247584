// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/inspect.h"
#include "tests/support/flat_mesh.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace toile;

namespace {

struct Cloth {
    Garment garment;
    Points x;
};

Cloth flat_square() {
    const test::FlatMesh mesh = test::jittered_rectangle(0.2, 0.2, 0.02, 0.2, 3);
    return {test::garment_of(mesh), test::flat_points(mesh)};
}

/// A garment without a pattern over a mesh.
Cloth cloth_of(const TriMesh& mesh) {
    Cloth c;
    c.garment.triangles = mesh.triangles;
    c.garment.panel_of_triangle.assign(mesh.triangles.size(), 0);
    c.garment.panel_names = {"cloth"};
    c.garment.rest.edges.assign(mesh.triangles.size(), Mat2::Zero());
    c.garment.uv.assign(mesh.points.size(), Vec2::Zero());
    c.garment.node_count = int(mesh.points.size());
    for (int i = 0; i < c.garment.node_count; ++i)
        c.garment.node_of_vertex.push_back(i);
    c.garment.edges = make_edges(mesh.triangles, c.garment.node_count);
    c.garment.seam_edge.assign(c.garment.edges.size(), false);
    c.garment.eased_triangle.assign(mesh.triangles.size(), false);
    c.x = mesh.points;
    return c;
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
