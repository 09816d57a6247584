// SPDX-License-Identifier: GPL-3.0-or-later
// The bars that bending has to clear on unstructured meshes. bench/bench_bending.cpp has the same on five
// meshes and finer ones, for rivals too; docs/bending.md the figures.

#include "draping/energy/bend.h"
#include "draping/energy/stretch.h"

#include "tests/support/clamped_strip.h"

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

std::vector<Term> plate_terms(const Garment& garment, const Fabric& fabric) {
    return {stretch_term(make_stretch(garment, {fabric}), garment.node_count),
            bend_term(make_bending(garment, {fabric}), garment.node_count)};
}

ClampedStrip strip(int along, std::uint64_t seed, const Fabric& fabric) {
    return clamped_strip(jittered_rectangle(1, 0.25, 1.0 / along, 0.3, seed),
                         [&](const Garment& g) { return plate_terms(g, fabric); });
}

double tip_slope(int along, std::uint64_t seed, const Fabric& fabric) {
    const Hung hung = hang(strip(along, seed, fabric), 10);
    REQUIRE(hung.converged);
    CHECK(hung.stable);
    return hung.drop_over_reach;
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
        const ClampedStrip s = strip(20, seed, plate(2e6, 1));
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
