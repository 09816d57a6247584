// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of cloth on edge midpoints: what ghost nodes see, lengths and their derivatives, bending.

#include "draping/nonconforming/cloth.h"

#include "tests/support/midpoint_strip.h"

#include <catch2/catch.hpp>

#include <Eigen/Dense>

#include <functional>

using namespace toile;
using namespace toile::test;
using Eigen::VectorXd;

namespace {

/// Means over straight flat edges of a map that is at most cubic along them, by Simpson's rule.
Points edge_means(const Garment& garment, const FlatMesh& mesh, const std::function<Vec3(const Vec2&)>& map) {
    Points x;
    for (const auto& [a, b] : garment.edges.ends)
        x.push_back(
            (map(mesh.points[a]) + map(mesh.points[b]) + 4 * map((mesh.points[a] + mesh.points[b]) / 2)) / 6);
    return x;
}

std::function<Vec3(const Vec2&)> quadratic(double uu, double vv, double uv) {
    return [=](const Vec2& p) -> Vec3 {
        return {p.x(), p.y(), 0.5 * (uu * p.x() * p.x() + vv * p.y() * p.y()) + uv * p.x() * p.y()};
    };
}

Fabric orthotropic() {
    Fabric f = sheet_fabric(0.2, 1);
    f.bend_warp = 3;
    f.bend_weft = 1;
    f.bend_twist = 0.7;
    f.bend_poisson = 0.25;
    return f;
}

double energy_per_area(const Fabric& f, double uu, double vv, double uv) {
    const double c = f.bend_poisson * std::sqrt(f.bend_warp * f.bend_weft);
    return 0.5 *
           (f.bend_weft * uu * uu + f.bend_warp * vv * vv + 2 * c * uu * vv + 4 * f.bend_twist * uv * uv);
}

Points shaken(Points x, double by, std::uint64_t seed) {
    Random random(seed);
    for (Vec3& p : x)
        p += random.vec3(by);
    return x;
}

VectorXd directions(std::size_t points, std::uint64_t seed) {
    return flat(shaken(Points(points, Vec3::Zero()), 1, seed));
}

Points moved(const Points& x, const VectorXd& d, double t) {
    Points y = x;
    flat(y) += t * d;
    return y;
}

} // namespace

TEST_CASE("ghost nodes of midpoints of straight edges are the nodes", "[midpoints]") {
    const FlatMesh mesh = jittered_rectangle(1, 0.5, 0.1, 0.3, 2);
    const Garment garment = garment_of(mesh);
    const Midpoints midpoints = make_midpoints(garment, {sheet_fabric(0.2, 1)});
    const Points nodes = shaken(flat_points(mesh), 0.3, 5), x = midpoints_of(garment, nodes);
    const Points ghosts = ghost_nodes(midpoints, x);
    for (std::size_t i = 0; i < nodes.size(); ++i)
        CHECK((ghosts[i] - nodes[i]).norm() < 1e-14);

    double mass = 0;
    for (double m : midpoints.mass)
        mass += m;
    CHECK(mass == Approx(0.2 * 0.5));
    // Forces and velocities do the same work on either side of the map.
    const Points forces = shaken(Points(nodes.size(), Vec3::Zero()), 1, 6),
                 v = shaken(Points(x.size(), Vec3::Zero()), 1, 7);
    const Points ghost_v = ghost_nodes(midpoints, v);
    CHECK(flat(from_ghost_nodes(midpoints, forces)).dot(flat(v)) == Approx(flat(forces).dot(flat(ghost_v))));
    CHECK_THROWS_WITH(make_midpoints(garment, {sheet_fabric(0, 1)}),
                      Catch::Contains("density must be positive"));
}

TEST_CASE("lengths of bars have the derivatives that are told", "[midpoints]") {
    const FlatMesh mesh = jittered_rectangle(1, 0.5, 0.1, 0.3, 2);
    const Garment garment = garment_of(mesh);
    const Bars bars = triangle_bars(garment);
    const Points rest = midpoints_of(garment, flat_points(mesh)), x = shaken(rest, 0.02, 3);
    CHECK(bars.size() == 3 * garment.triangles.size());
    CHECK(largest_strain(bars, rest) < 1e-13);
    CHECK(largest_triangle_strain(garment, rest) < 1e-13);
    CHECK(largest_triangle_strain(garment, x) > 0.1);

    const VectorXd d = directions(x.size(), 4), lambda = directions(bars.size(), 5).head(bars.size());
    const double h = 1e-5;
    const VectorXd difference = (misfit(bars, moved(x, d, h)) - misfit(bars, moved(x, d, -h))) / (2 * h);
    const VectorXd slope = lengthening(bars, x, d);
    CHECK(slope.norm() > 1);
    CHECK((difference - slope).norm() < 1e-9 * slope.norm());
    VectorXd forces = VectorXd::Zero(d.size());
    add_tensions(bars, x, lambda, forces);
    CHECK(forces.dot(d) == Approx(lambda.dot(slope)));
}

TEST_CASE("a triangle that has no area cannot keep its shape", "[midpoints]") {
    FlatMesh mesh{{{0, 0}, {1, 0}, {2, 0}}, {{0, 1, 2}}};
    CHECK_THROWS_WITH(triangle_bars(garment_of(mesh)), Catch::Contains("triangle 0 has no area"));
}

TEST_CASE("bending on midpoints is exact on quadratics, borders and seams included", "[midpoints]") {
    const Fabric fabric = orthotropic();
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const FlatMesh mesh = jittered_rectangle(1, 0.25, 0.05, 0.3, seed);
        const Garment garment = garment_of(mesh);
        const MidpointBending bending = make_midpoint_bending(garment, {fabric});
        for (const auto& [uu, vv, uv] : {std::array{1.0, 0.0, 0.0}, {0, 1, 0}, {0, 0, 1}, {1, -2, 0.5}})
            CHECK(bend_value(bending, edge_means(garment, mesh, quadratic(uu, vv, uv))) ==
                  Approx(0.25 * energy_per_area(fabric, uu, vv, uv)).epsilon(1e-9));
    }
    const FlatMesh mesh = jittered_rectangle(1, 0.5, 0.07, 0.3, 3);
    const Fabric isotropic = sheet_fabric(1, 2);
    const Garment whole = garment_of(mesh), sewn = cut_and_sewn(mesh, 0.45, 0.2, 1.3);
    const Points x = edge_means(whole, mesh, quadratic(1, -2, 0.5));
    CHECK(bend_value(make_midpoint_bending(sewn, {isotropic, isotropic}), x) ==
          Approx(bend_value(make_midpoint_bending(whole, {isotropic}), x)).epsilon(1e-10));
}

TEST_CASE("cloth on midpoints bent to a quadratic is in equilibrium inside", "[midpoints]") {
    const FlatMesh mesh = jittered_rectangle(1, 1, 0.08, 0.3, 11);
    const Garment garment = garment_of(mesh);
    const MidpointBending bending = make_midpoint_bending(garment, {orthotropic()});
    const Points gradient = bend_gradient(bending, edge_means(garment, mesh, quadratic(1, -2, 0.5)));
    double inside = 0, all = 0;
    for (int e = 0; e < garment.edges.size(); ++e) {
        const Vec2 p = (mesh.points[garment.edges.ends[e][0]] + mesh.points[garment.edges.ends[e][1]]) / 2;
        all = std::max(all, gradient[e].norm());
        if (std::min(p.minCoeff(), 1 - p.maxCoeff()) > 0.35) inside = std::max(inside, gradient[e].norm());
    }
    CHECK(inside < 1e-9 * all);
}

TEST_CASE("bending on midpoints: derivatives, rigid motions and what is left free", "[midpoints]") {
    const FlatMesh mesh = strip_mesh(MeshKind::unstructured, 1, 0.25, 8);
    const Garment garment = garment_of(mesh);
    const MidpointBending bending =
        make_midpoint_bending(garment, {orthotropic()}, level_clamps(edges_at_wall(mesh, garment)));
    const Points x = shaken(midpoints_of(garment, flat_points(mesh)), 0.05, 3);
    const VectorXd d = directions(x.size(), 4);
    const double h = 1e-5;
    const double difference =
        (bend_value(bending, moved(x, d, h)) - bend_value(bending, moved(x, d, -h))) / (2 * h);
    const Points gradient = bend_gradient(bending, x);
    CHECK(flat(gradient).norm() > 1);
    CHECK(difference == Approx(flat(gradient).dot(d)).epsilon(1e-7));
    const Points ahead = bend_gradient(bending, moved(x, d, h)),
                 behind = bend_gradient(bending, moved(x, d, -h));
    const VectorXd turned = (flat(ahead) - flat(behind)) / (2 * h);
    for (int c = 0; c < 3; ++c) {
        VectorXd dc(x.size()), tc(x.size());
        for (std::size_t i = 0; i < x.size(); ++i)
            dc[i] = d[3 * i + c], tc[i] = turned[3 * i + c];
        CHECK((bending.stiffness * dc - tc).norm() < 1e-7 * tc.norm());
    }

    // Flat cloth has no energy, wherever it lies; all else has, so that triangles cannot turn against each
    // other.
    const MidpointBending loose = make_midpoint_bending(garment, {orthotropic()});
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes{Eigen::MatrixXd(loose.stiffness)};
    CHECK(modes.eigenvalues()[2] < 1e-12 * modes.eigenvalues().maxCoeff());
    CHECK(modes.eigenvalues()[3] > 1e-8 * modes.eigenvalues().maxCoeff());
    Points turned_flat;
    const Eigen::AngleAxisd turn(1.1, Vec3(1, 2, 3).normalized());
    for (const Vec3& p : midpoints_of(garment, flat_points(mesh)))
        turned_flat.push_back(turn * p + Vec3(5, 6, 7));
    CHECK(bend_value(loose, turned_flat) < 1e-20 * bend_value(loose, x));
}

TEST_CASE("a clamped edge is level cloth without energy, and any other slope costs", "[midpoints]") {
    const FlatMesh mesh = strip_mesh(MeshKind::unstructured, 1, 0.25, 8);
    const Garment garment = garment_of(mesh);
    const MidpointBending bending =
        make_midpoint_bending(garment, {sheet_fabric(1, 1)}, level_clamps(edges_at_wall(mesh, garment)));
    Points level, tilted;
    for (const Vec3& p : midpoints_of(garment, flat_points(mesh))) {
        level.push_back(p + Vec3(1, 2, 3));
        tilted.push_back({p.x(), p.y(), 0.1 * p.x()});
    }
    CHECK(bend_value(bending, level) < 1e-25);
    CHECK(bend_value(bending, tilted) > 0.01);
    CHECK_THROWS_WITH(
        make_midpoint_bending(garment, {sheet_fabric(1, 1)}, level_clamps({garment.edges.size()})),
        Catch::Contains("of a clamp does not exist"));
}

TEST_CASE("cloth too small for exact slopes still bends", "[midpoints]") {
    const FlatMesh two{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}}},
        one{{{0, 0}, {1, 0}, {1, 1}}, {{0, 1, 2}}};
    const Garment pair = garment_of(two);
    const MidpointBending bending = make_midpoint_bending(pair, {sheet_fabric(1, 1)});
    Points folded = midpoints_of(pair, flat_points(two));
    CHECK(bend_value(bending, folded) < 1e-25);
    folded = midpoints_of(pair, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5}});
    CHECK(bend_value(bending, folded) > 0.01);
    const Garment single = garment_of(one);
    CHECK(bend_value(make_midpoint_bending(single, {sheet_fabric(1, 1)}),
                     shaken(Points(3, Vec3::Zero()), 1, 2)) < 1e-20);
}

TEST_CASE("three panels on one edge are a hinge on midpoints", "[midpoints]") {
    FlatMesh mesh{{{0, 0}, {1, 0}, {0.5, 1}, {0.5, -1}, {0.5, 0.5}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
    const Garment garment = garment_of(mesh);
    REQUIRE(garment.edges.triangles_at(0) == 3);
    const NonconformingCloth cloth = make_nonconforming_cloth(garment, {sheet_fabric(1, 1)});
    const Points spread =
        midpoints_of(garment, {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, -1, 0}, {0.5, 0, 0.5}});
    CHECK(bend_value(cloth.bending, spread) < 1e-25);
    CHECK(largest_strain(cloth.bars, spread) < 1e-14);
    const Points nodes = ghost_nodes(cloth.midpoints, spread);
    CHECK((nodes[4] - Vec3(0.5, 0, 0.5)).norm() < 1e-14);
}
