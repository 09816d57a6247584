// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth on edge midpoints brought to rest by its energy, with the barrier.

#include "draping/method.h"
#include "draping/nonconforming/midpoint_cloth.h"
#include "draping/settle_cloth.h"
#include "tests/support/flat_mesh.h"
#include "tests/support/plain_fabric.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double g = 9.81;

TriMesh ball() {
    TriMesh mesh = sphere(0.1, 3);
    for (Vec3& p : mesh.points) p.y() -= 0.1;
    return mesh;
}

/// A level sheet of 20 cm, `stretched` along x, its middle 2 mm above the origin.
struct Sheet20 {
    FlatMesh mesh = jittered_rectangle(0.2, 0.2, 0.02, 0.25, 7);
    Garment garment = garment_of(mesh);
    Fabric fabric = plain_fabric(1000, 1e-5);
    Points nodes;

    explicit Sheet20(double stretched) {
        for (const Vec2& p : mesh.points) nodes.push_back({stretched * (p.x() - 0.1), 0.002, 0.1 - p.y()});
    }
};

SettleResult brought_to_rest(ClothProblem& problem, Points& nodes) {
    Cholesky factor;
    SettleOptions o;
    o.max_iterations = 1000;
    return settle_constrained(problem, nodes, o, [&](const SettleOptions& some) { return settle_cloth(problem, nodes, factor, some); });
}

} // namespace

TEST_CASE("cloth on midpoints as an energy has the derivatives that differences have", "[nonconforming]") {
    Sheet20 s(1.03);
    auto model = std::make_unique<MidpointCloth>(s.garment, std::vector<Fabric>{s.fabric});
    MidpointCloth& cloth = *model;
    std::vector<double> mass = cloth.masses(node_masses(s.garment, {s.fabric}));
    FreeCloth problem(std::move(model), mass);
    problem.gravity = g;
    Points x;
    cloth.carry(x, s.nodes);
    Random random(5);
    for (Vec3& p : x) p += random.vec3(1e-3);
    CHECK(cloth.take_up(x)); // so that bars and ties have forces, of which some push
    Eigen::VectorXd at, ahead, behind, product;
    problem.gradient(x, at);
    for (int trial = 0; trial < 3; ++trial) {
        Eigen::VectorXd d(at.size());
        for (double& c : d) c = random.in(-1, 1);
        const auto moved = [&](double t) {
            Points y = x;
            flat(y) += t * d;
            return y;
        };
        const double slope = (problem.value(moved(1e-6)) - problem.value(moved(-1e-6))) / 2e-6;
        CHECK(std::abs(slope - at.dot(d)) < 1e-6 * at.norm() * d.norm());
        bool changed = false;
        problem.hessian(x, true, changed);
        problem.multiply(d, product);
        problem.gradient(moved(1e-6), ahead);
        problem.gradient(moved(-1e-6), behind);
        CHECK(((ahead - behind) / 2e-6 - product).norm() < 1e-6 * product.norm());
    }
    bool changed = false;
    BlockMatrix& projected = problem.hessian(x, false, changed);
    Eigen::VectorXd shift = Eigen::VectorXd::Constant(projected.rows(), 1e-6);
    projected.add_to_diagonal(shift);
    Cholesky factor;
    factor.analyse(projected);
    CHECK(factor.factorise(projected));
}

TEST_CASE("midpoints are carried along with nodes and leave no gap", "[nonconforming]") {
    Sheet20 s(1);
    const MidpointCloth cloth(s.garment, {s.fabric});
    Points x;
    cloth.carry(x, s.nodes);
    CHECK(cloth.largest_gap(x) < 1e-12);
    Random random(5);
    for (Vec3& p : s.nodes) p += random.vec3(0.01);
    cloth.carry(x, s.nodes);
    CHECK(cloth.largest_gap(x) < 1e-12);
    for (int i = 0; i < s.garment.node_count; ++i) CHECK(x[i] == s.nodes[i]);
    double weight = 0, of_nodes = 0;
    for (const double m : node_masses(s.garment, {s.fabric})) of_nodes += m;
    for (const double m : cloth.masses(node_masses(s.garment, {s.fabric}))) weight += m;
    CHECK(weight == Approx(of_nodes).epsilon(1e-12));
}

TEST_CASE("a sheet on midpoints comes to rest on a sphere with its lengths from wrong ones", "[nonconforming]") {
    for (const double stretched : {1.0, 1.1}) {
        INFO("stretched " << stretched);
        Sheet20 s(stretched);
        const TriMesh body = ball();
        ClothProblem problem(make_energy(Method::nonconforming, s.garment, {s.fabric}, {}), s.garment, {s.fabric}, body,
                             barriers_at(0.5e-3, s.fabric.density));
        problem.gravity = g;
        int middle = 0;
        for (int i = 0; i < s.garment.node_count; ++i)
            if (s.nodes[i].norm() < s.nodes[middle].norm()) middle = i;
        s.nodes[middle].y() = 1e-3;
        problem.pin(middle); // it could slide off
        problem.rest_here(s.nodes, {0.3, 0.3});
        const SettleResult r = brought_to_rest(problem, s.nodes);
        INFO("residual " << r.residual << " after " << r.iterations << " iterations");
        CHECK(r.end == SettleEnd::settled);
        CHECK(r.residual <= 1e-3);
        CHECK(*problem.kept_strain() < 1e-6);
        const IntersectionCount n = count_intersections(node_triangles(s.garment), s.nodes, body);
        CHECK(n.cloth_avatar + n.cloth_cloth == 0);
        Vec3 force = Vec3::Zero();
        double weight = 0, low = 0;
        for (const Vec3& f : problem.contact().body_forces(problem.contact().active(s.nodes))) force += f;
        for (const double m : problem.node_mass()) weight += g * m;
        for (const Vec3& p : s.nodes) low = std::min(low, p.y());
        CHECK(force.y() > 0.2 * weight);
        CHECK(low < -0.05); // it hangs down
    }
}
