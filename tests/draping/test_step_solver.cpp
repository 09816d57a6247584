// SPDX-License-Identifier: GPL-3.0-or-later
// The dual of the lengths of cloth on midpoints, and steps in time by it, against dense algebra and the direct solver.

#include "draping/nonconforming/step_solver.h"

#include "draping/nonconforming/cloth.h"
#include "draping/nonconforming/ghost_impulses.h"
#include "tests/support/midpoint_strip.h"

#include <catch2/catch.hpp>

#include <Eigen/Dense>

using namespace toile;
using namespace toile::test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Scene {
    FlatMesh mesh = strip_mesh(MeshKind::unstructured, 0.3, 0.15, 8, 2);
    Garment garment = garment_of(mesh);
    NonconformingCloth cloth = make_nonconforming_cloth(garment, {sheet_fabric(0.15, 1e-4)});
    Points x = midpoints_of(garment, flat_points(mesh));
    Random random{5};

    HeldPlace place(int node) const {
        HeldPlace p;
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator e(cloth.midpoints.ghost, node); e; ++e)
            p.emplace_back(int(e.col()), e.value());
        return p;
    }
    VectorXd vector(Eigen::Index size, double by = 1) {
        VectorXd v(size);
        for (double& entry : v) entry = random.in(-by, by);
        return v;
    }
};

Points moved(Points x, const VectorXd& d, double t) {
    flat(x) += t * d;
    return x;
}

} // namespace

TEST_CASE("the dual's conditions have the derivatives that lengths and places have", "[midpoints]") {
    Scene s;
    for (Vec3& p : s.x) p += s.random.vec3(0.005);
    IsometryDual dual(int(s.x.size()), s.cloth.bars, {s.place(3), s.place(7)});
    dual.linearise(s.x);
    const VectorXd d = s.vector(3 * Eigen::Index(s.x.size())), slope = dual.product(d);
    const double h = 1e-6;
    const VectorXd lengths = (misfit(s.cloth.bars, moved(s.x, d, h)) - misfit(s.cloth.bars, moved(s.x, d, -h))) / (2 * h);
    CHECK(lengths.norm() > 1);
    CHECK((slope.head(lengths.size()) - lengths).norm() < 1e-8 * lengths.norm());
    const Points nodes = ghost_nodes(s.cloth.midpoints, moved(Points(s.x.size(), Vec3::Zero()), d, 1));
    CHECK((slope.segment<3>(lengths.size()) - nodes[3]).norm() < 1e-14);
    CHECK((slope.tail<3>() - nodes[7]).norm() < 1e-14);
    const VectorXd y = s.vector(dual.conditions());
    CHECK(dual.transpose_product(y).dot(d) == Approx(y.dot(slope)));
}

TEST_CASE("the dual's multipliers are those of the dense Schur complement", "[midpoints]") {
    Scene s;
    for (Vec3& p : s.x) p += s.random.vec3(0.005);
    IsometryDual dual(int(s.x.size()), s.cloth.bars, {s.place(3)});
    std::vector<Mat3> mobility;
    for (std::size_t e = 0; e < s.x.size(); ++e) {
        const Mat3 a = s.vector(9).reshaped(3, 3);
        mobility.push_back(e == 5 ? Mat3::Zero() : Mat3(a * a.transpose() + Mat3::Identity()));
    }
    dual.linearise(s.x);
    REQUIRE(dual.factorise(mobility));
    const int n = 3 * int(s.x.size()), m = dual.conditions();
    MatrixXd j(m, n), inverse = MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i) j.col(i) = dual.product(VectorXd::Unit(n, i));
    for (int e = 0; e < n / 3; ++e) inverse.block<3, 3>(3 * e, 3 * e) = mobility[e];
    const VectorXd c = s.vector(m), y = dual.multipliers(c), exact = (j * inverse * j.transpose()).ldlt().solve(c);
    CHECK((y - exact).norm() < 1e-5 * exact.norm());
    CHECK((dual.mobile(dual.transpose_product(y)) - inverse * j.transpose() * y).norm() < 1e-12 * y.norm() * inverse.norm());
}

TEST_CASE("a step by the dual is that of the direct solver", "[midpoints]") {
    Scene s;
    IsometricProblem problem = problem_of(s.cloth, Vec3(0, 0, -9.81), {}, {{3, flat_points(s.mesh)[3], 20}});
    problem.held[edges_at_wall(s.mesh, s.garment)[0]] = 1;
    const double inertia = 1 / (2e-3 * 2e-3);
    Points thrown = s.x;
    for (Vec3& p : thrown) p += Vec3(0, 2e-3 * p.x(), 1e-2 * p.x() * p.x());
    StepProblem step{problem, s.cloth.midpoints, problem.load, {}, nullptr, s.x,
                     VectorXd::Zero(Eigen::Index(s.cloth.bars.size()))};
    IsometricProblem whole = problem;
    for (std::size_t e = 0; e < s.x.size(); ++e) {
        step.inertia.push_back(inertia * s.cloth.midpoints.mass[e]);
        step.load[e] += step.inertia[e] * thrown[e];
        whole.stiffness.coeffRef(e, e) += step.inertia[e];
        whole.load[e] += step.inertia[e] * thrown[e];
    }
    StepSolver solver(problem, {});
    Saddle saddle(whole.stiffness, whole.bars, whole.held);
    Points fast = s.x, slow = s.x;
    VectorXd tension;
    StepSolverOptions o;
    o.tolerance = 1e-10;
    const IsometricResult r = solver.step(step, fast, tension, o);
    CHECK(r.end == IsometricEnd::settled);
    IsometricOptions direct;
    direct.tolerance = 1e-10;
    direct.strain = 1e-9;
    const IsometricResult exact = settle_isometric(saddle, whole, slow, direct);
    REQUIRE(exact.end == IsometricEnd::settled);
    double way = 0, off = 0;
    for (std::size_t e = 0; e < fast.size(); ++e) {
        way = std::max(way, (slow[e] - s.x[e]).norm());
        off = std::max(off, (fast[e] - slow[e]).norm());
    }
    CHECK(way > 1e-4);
    CHECK(off < 1e-5 * way);
    CHECK((tension - exact.tension).norm() < 1e-4 * exact.tension.norm());
}

TEST_CASE("impulses on ghost nodes move them as asked, with the momentum of nodes and the least energy", "[midpoints]") {
    Scene s;
    const GhostImpulses impulses(s.cloth.midpoints, std::vector<char>(s.x.size(), 0));
    std::vector<double> node_mass(s.garment.node_count, 0);
    for (std::size_t t = 0; t < s.garment.triangles.size(); ++t)
        for (int node : s.garment.nodes(int(t))) node_mass[node] += 0.15 * rest_area(s.garment.rest.edges[t]) / 3;
    Points change;
    for (int i = 0; i < s.garment.node_count; ++i) change.push_back(i % 3 ? Vec3(Vec3::Zero()) : s.random.vec3(1));
    const Points v = impulses.velocities(change), nodes = ghost_nodes(s.cloth.midpoints, v);
    Vec3 of_nodes = Vec3::Zero(), of_midpoints = Vec3::Zero();
    double energy = 0, other = 0, across = 0;
    for (std::size_t i = 0; i < change.size(); ++i) {
        CHECK((nodes[i] - change[i]).norm() < 1e-11);
        of_nodes += node_mass[i] * change[i];
    }
    // Motions that no ghost node sees have no part in it.
    Points unseen(s.x.size());
    for (Vec3& u : unseen) u = s.random.vec3(1);
    const Points seen = impulses.velocities(ghost_nodes(s.cloth.midpoints, unseen));
    for (std::size_t e = 0; e < s.x.size(); ++e) {
        const double m = s.cloth.midpoints.mass[e];
        of_midpoints += m * v[e];
        energy += m * v[e].squaredNorm();
        other += m * (unseen[e] - seen[e]).squaredNorm();
        across += m * v[e].dot(unseen[e] - seen[e]);
    }
    CHECK(of_nodes.norm() > 0);
    CHECK((of_midpoints - of_nodes).norm() < 1e-11 * of_nodes.norm());
    CHECK(other > 0);
    CHECK(std::abs(across) < 1e-9 * std::sqrt(energy * other));
}
