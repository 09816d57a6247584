// SPDX-License-Identifier: GPL-3.0-or-later
// The bars that bending has to clear on unstructured meshes. bench/bench_bending.cpp has the same on five
// meshes and finer ones, for rivals too; docs/bending.md the figures.

#include "draping/energy/bend.h"
#include "draping/energy/stretch.h"

#include "tests/support/plates.h"
#include "tests/support/static_solver.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;
using Eigen::VectorXd;

namespace {

constexpr double pi = std::numbers::pi;

Fabric plate(double k, double compression) {
    Fabric f;
    f.name = "plate";
    f.stretch_warp = f.stretch_weft = k;
    f.shear = k / 2;
    f.compression = compression;
    f.bend_warp = f.bend_weft = 1;
    f.bend_twist = 0.5;
    return f;
}

struct Strip {
    FlatMesh mesh;
    int nodes;
    std::vector<Term> terms;
    std::vector<double> areas;
};

Strip strip(int along, std::uint64_t seed, const Fabric& fabric) {
    Strip s;
    s.mesh = mirrored(jittered_rectangle(1, 0.25, 1.0 / along, 0.3, seed));
    const Garment garment = garment_of(s.mesh);
    s.nodes = garment.node_count;
    s.terms = {stretch_term(make_stretch(garment, {fabric}), s.nodes),
               bend_term(make_bending(garment, {fabric}), s.nodes)};
    s.areas = node_areas(garment);
    return s;
}

// Both arms by one: nodes at x = 0 are held, those at x < 0 mirror those at x > 0.
Freedoms clamped(const Strip& s, const VectorXd& q) {
    Freedoms freedoms(q);
    const std::vector<int> twin = twins(s.mesh.points);
    for (int i = 0; i < s.nodes; ++i)
        for (int c = 0; c < 3; ++c) {
            if (std::abs(s.mesh.points[i].x()) < 1e-12) freedoms.hold(3 * i + c, q[3 * i + c]);
            if (twin[i] != i) freedoms.tie(3 * i + c, 3 * twin[i] + c, c == 0 ? -1 : 1);
        }
    freedoms.number();
    return freedoms;
}

double tip_slope(int along, std::uint64_t seed, const Fabric& fabric) {
    const Strip s = strip(along, seed, fabric);
    const std::vector<Vec2> curve = elastica(10);
    VectorXd q(3 * s.nodes), load = VectorXd::Zero(3 * s.nodes);
    for (int i = 0; i < s.nodes; ++i) {
        const Vec2& p = s.mesh.points[i];
        const Vec2 at = curve[std::lround(std::abs(p.x()) * (int(curve.size()) - 1))];
        q.segment<3>(3 * i) << std::copysign(at.x(), p.x()), p.y(), -at.y();
        load[3 * i + 2] = -10 * s.areas[i];
    }
    const StaticResult r = solve_static(s.terms, load, clamped(s, q), q);
    REQUIRE(r.converged);
    CHECK(r.stable);
    double x = 0, z = 0;
    for (int i = 0; i < s.nodes; ++i)
        if (s.mesh.points[i].x() > 1 - 1e-9) x += r.q[3 * i], z -= r.q[3 * i + 2];
    return z / x;
}

} // namespace

TEST_CASE("the reference elastica is the one of the tables", "[validation]") {
    const Vec2 tip = elastica(10).back();
    CHECK(tip.y() / tip.x() == Approx(1.06680232).epsilon(1e-6));
}

TEST_CASE("cantilever under its own weight", "[validation]") {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        CHECK(tip_slope(20, seed, plate(1e3, 1)) == Approx(1.06680232).epsilon(0.03));
        CHECK(tip_slope(20, seed, plate(2e6, 1)) == Approx(1.06680232).epsilon(0.03));
    }
    CHECK(tip_slope(40, 1, plate(1e3, 1)) == Approx(1.06680232).epsilon(0.015));
    CHECK(tip_slope(40, 1, plate(2e6, 1)) == Approx(1.06680232).epsilon(0.015));
    CHECK(tip_slope(20, 1, plate(2e6, 0.1)) == Approx(1.06680232).epsilon(0.03));
}

TEST_CASE("a sheet rolled on a cylinder, in 8 directions", "[validation]") {
    const double kappa = 2;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const FlatMesh mesh = jittered_rectangle(1, 1, 0.05, 0.3, seed);
        const Garment garment = garment_of(mesh);
        const Fabric fabric = plate(2e6, 1);
        const Bending bending = make_bending(garment, {fabric});
        const std::vector<StretchElement> stretch = make_stretch(garment, {fabric});
        for (int direction = 0; direction < 8; ++direction) {
            const double a = pi * direction / 8;
            Points x;
            for (const Vec2& p : mesh.points) {
                const double u = std::cos(a) * p.x() + std::sin(a) * p.y(),
                             v = std::cos(a) * p.y() - std::sin(a) * p.x();
                x.push_back({std::sin(kappa * u) / kappa, v, (1 - std::cos(kappa * u)) / kappa});
            }
            CHECK(bend_value(bending, x) == Approx(0.5 * kappa * kappa).epsilon(0.01));
            // Chords would hold 40 times the bending energy in the membrane at this stiffness.
            CHECK(stretch_value(stretch, x) < 0.02 * kappa * kappa);
        }
    }
}

TEST_CASE("a twisted sheet", "[validation]") {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const FlatMesh mesh = jittered_rectangle(1, 1, 0.05, 0.3, seed);
        const Bending bending = make_bending(garment_of(mesh), {plate(1, 1)});
        Points x;
        for (const Vec2& p : mesh.points)
            x.push_back({p.x(), p.y(), 0.1 * p.x() * p.y()});
        CHECK(bend_value(bending, x) == Approx(0.5 * 4 * 0.5 * 0.01).epsilon(1e-6));
    }
}

TEST_CASE("lateral buckling of a strip on edge", "[validation]") {
    const double critical = 21.3255;
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        const Strip s = strip(20, seed, plate(2e6, 1));
        VectorXd q(3 * s.nodes), load = VectorXd::Zero(3 * s.nodes);
        for (int i = 0; i < s.nodes; ++i) {
            q.segment<3>(3 * i) << s.mesh.points[i].x(), s.mesh.points[i].y(), 0;
            load[3 * i + 1] = -s.areas[i];
        }
        const Freedoms all = clamped(s, q);
        Freedoms plane = all;
        for (int i = 0; i < s.nodes; ++i)
            plane.hold(3 * i + 2, 0);
        plane.number();
        const auto stands = [&](double gamma) {
            const StaticResult r = solve_static(s.terms, gamma * load, plane, q);
            REQUIRE(r.converged);
            Entries entries;
            for (const Term& term : s.terms)
                term.add_hessian(r.q, HessianKind::exact, entries);
            return positive_definite(all.reduce(entries));
        };
        CHECK(stands(0.97 * critical));
        CHECK_FALSE(stands(1.03 * critical));
    }
}
