// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth in its own plane, and cloth that hangs, against closed forms.

#include "draping/energy/bend.h"
#include "draping/energy/stretch.h"

#include "tests/support/plates.h"
#include "tests/support/pulled_square.h"
#include "tests/support/static_solver.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;
using Eigen::VectorXd;

namespace {

Fabric orthotropic() {
    Fabric f;
    f.name = "orthotropic";
    f.stretch_warp = 1000;
    f.stretch_weft = 600;
    f.poisson = 0.3;
    f.shear = 40;
    f.compression = 0.1;
    f.bend_warp = f.bend_weft = 1e-5;
    f.bend_twist = 5e-6;
    return f;
}

VectorXd flat_start(const FlatMesh& mesh) {
    Points x = flat_points(mesh);
    return flat(x);
}

void hold_height(Freedoms& freedoms, int nodes) {
    for (int i = 0; i < nodes; ++i)
        freedoms.hold(3 * i + 2, 0);
}

// Engineering stress along x of a sheet of size 1 x 1 pulled by the map (x, y) -> (a x, b y), from forces at
// x = 1.
Vec2 border_stress(const std::vector<StretchElement>& elements, const FlatMesh& mesh, double a, double b) {
    Points x, gradient(mesh.points.size(), Vec3::Zero());
    for (const Vec2& p : mesh.points)
        x.push_back({a * p.x(), b * p.y(), 0});
    stretch_gradient(elements, x, gradient);
    Vec2 stress(0, 0);
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        if (mesh.points[i].x() > 1 - 1e-9) stress.x() += gradient[i].x();
        if (mesh.points[i].y() > 1 - 1e-9) stress.y() += gradient[i].y();
    }
    return stress;
}

// Of a unit square with its grain turned by `angle`.
Vec2 off_axis_strain(double angle, double stress) {
    const Garment garment = garment_of(unit_square(), angle);
    return pulled_strain(stretch_term(make_stretch(garment, {orthotropic()}), garment.node_count), stress);
}

} // namespace

TEST_CASE("uniaxial tension along the warp, at large strain", "[validation]") {
    const FlatMesh mesh = jittered_rectangle(1, 1, 0.2, 0.25, 1);
    const Garment garment = garment_of(mesh, 0.5 * std::numbers::pi); // warp along x
    const int n = garment.node_count;
    const std::vector<StretchElement> elements = make_stretch(garment, {orthotropic()});
    for (const auto& [stretch, force, across] :
         {std::array{1.01, 10.1505, 0.99698044}, {1.1, 115.5, 0.96798760}, {1.2, 264.0, 0.93166518}}) {
        VectorXd q = flat_start(mesh);
        for (int i = 0; i < n; ++i)
            q[3 * i] *= stretch;
        Freedoms freedoms(q);
        hold_height(freedoms, n);
        for (int i = 0; i < n; ++i)
            if (std::abs(mesh.points[i].x() - 0.5) > 0.5 - 1e-9) freedoms.hold(3 * i, q[3 * i]);
        freedoms.hold(1, q[1]);
        freedoms.number();
        StaticOptions options;
        options.tolerance = 1e-8;
        VectorXd load = VectorXd::Zero(3 * n);
        load[1] = 1; // on a node that is held: only sets the scale of the residual
        const StaticResult r = solve_static({stretch_term(elements, n)}, load, freedoms, q, options);
        REQUIRE(r.converged);
        VectorXd g = VectorXd::Zero(3 * n);
        stretch_term(elements, n).add_gradient(r.q, g);
        double pull = 0, low = 1e9, high = -1e9;
        for (int i = 0; i < n; ++i) {
            if (mesh.points[i].x() > 1 - 1e-9) pull += g[3 * i];
            low = std::min(low, r.q[3 * i + 1]);
            high = std::max(high, r.q[3 * i + 1]);
        }
        CHECK(pull == Approx(force).epsilon(1e-3));
        CHECK(high - low == Approx(across).epsilon(1e-4));
    }
}

TEST_CASE("biaxial tension", "[validation]") {
    const FlatMesh mesh = jittered_rectangle(1, 1, 0.2, 0.25, 1);
    const std::vector<StretchElement> elements =
        make_stretch(garment_of(mesh, 0.5 * std::numbers::pi), {orthotropic()});
    for (const auto& [stretch, warp, weft] : {std::array{1.01, 12.6613002, 8.3693340},
                                              {1.05, 67.1234144, 44.3697146},
                                              {1.1, 144.0697674, 95.2325581}}) {
        const Vec2 stress = border_stress(elements, mesh, stretch, stretch);
        CHECK(stress.x() == Approx(warp).epsilon(1e-6));
        CHECK(stress.y() == Approx(weft).epsilon(1e-6));
    }
}

TEST_CASE("a compressed yarn is slack and the other answers as in a uniaxial test", "[validation]") {
    const FlatMesh mesh = jittered_rectangle(1, 1, 0.2, 0.25, 1);
    Fabric fabric = orthotropic();
    fabric.compression = 1e-9;
    const std::vector<StretchElement> elements =
        make_stretch(garment_of(mesh, 0.5 * std::numbers::pi), {fabric});
    const Vec2 stress = border_stress(elements, mesh, 1.1, 0.8);
    CHECK(stress.x() == Approx(115.5).epsilon(1e-6));
    CHECK(std::abs(stress.y()) < 1e-4);
    CHECK(border_stress(elements, mesh, 0.9, 0.8).norm() < 1e-3);
}

TEST_CASE("picture frame", "[validation]") {
    const double side = 0.2;
    const FlatMesh mesh = jittered_rectangle(side, side, 0.05, 0.25, 1);
    const std::vector<StretchElement> elements = make_stretch(garment_of(mesh), {orthotropic()});
    const auto energy = [&](double angle) { // yarns keep their lengths and turn towards the diagonal
        const double c = std::cos(angle / 2), s = std::sin(angle / 2);
        Points x;
        for (const Vec2& p : mesh.points)
            x.push_back({c * p.x() + s * p.y(), s * p.x() + c * p.y(), 0});
        return stretch_value(elements, x);
    };
    const auto diagonal = [&](double angle) { return 2 * side * std::cos(std::numbers::pi / 4 - angle / 2); };
    for (const auto& [degrees, force] :
         {std::array{1.0, 0.1991669877}, {10, 2.128355545}, {30, 6.928203230}}) {
        const double angle = degrees * std::numbers::pi / 180, step = 1e-4;
        const double pull =
            (energy(angle + step) - energy(angle - step)) / (diagonal(angle + step) - diagonal(angle - step));
        CHECK(pull == Approx(force).epsilon(1e-3));
    }
}

TEST_CASE("stiffness off the grain", "[validation]") {
    for (const auto& [degrees, stiffness, poisson] : {std::array{0.0, 1000.0, 0.3},
                                                      {15, 416.14795, 0.690112},
                                                      {30, 190.779014, 0.834658},
                                                      {45, 147.783251, 0.847291},
                                                      {60, 179.372197, 0.784753},
                                                      {90, 600, 0.18}}) {
        // Turning the grain by 90 degrees lays the warp along x, which is 0 in the table.
        const double stress = 1e-4 * stiffness;
        const Vec2 strain = off_axis_strain((90 - degrees) * std::numbers::pi / 180, stress);
        INFO("off the warp by " << degrees);
        CHECK(stress / strain.x() == Approx(stiffness).epsilon(0.01));
        CHECK(-strain.y() / strain.x() == Approx(poisson).epsilon(0.01));
    }
}

TEST_CASE("a strip that hangs stretches by its own weight", "[validation]") {
    const FlatMesh mesh = jittered_rectangle(0.25, 1, 0.0625, 0.25, 2);
    const Garment garment = garment_of(mesh);
    const int n = garment.node_count;
    Fabric fabric = orthotropic();
    fabric.poisson = 0;
    fabric.stretch_warp = fabric.stretch_weft = 1;
    fabric.shear = 0.5;
    const VectorXd q = flat_start(mesh);
    const std::vector<double> areas = node_areas(garment);
    VectorXd load = VectorXd::Zero(3 * n);
    Freedoms freedoms(q);
    for (int i = 0; i < n; ++i) {
        load[3 * i + 1] = -0.1 * areas[i]; // weight over stiffness 0.1
        if (mesh.points[i].y() > 1 - 1e-9)
            for (int c = 0; c < 3; ++c)
                freedoms.hold(3 * i + c, q[3 * i + c]);
    }
    freedoms.number();
    const StaticResult r = solve_static(
        {stretch_term(make_stretch(garment, {fabric}), n), bend_term(make_bending(garment, {fabric}), n)},
        load, freedoms, q);
    REQUIRE(r.converged);
    double tip = 0;
    int tips = 0;
    for (int i = 0; i < n; ++i)
        if (mesh.points[i].y() < 1e-9) tip -= r.q[3 * i + 1], ++tips;
    CHECK(tip / tips == Approx(0.04579769).epsilon(0.01));
}

TEST_CASE("a strip between two supports hangs in a catenary", "[validation]") {
    const double length = 1.5, a = 0.30823646973604046, width = 0.05;
    const FlatMesh mesh = jittered_rectangle(length, width, length / 64, 0.2, 4);
    const Garment garment = garment_of(mesh);
    const int n = garment.node_count;
    Fabric fabric = orthotropic();
    fabric.poisson = 0;
    fabric.stretch_warp = fabric.stretch_weft = 1e5;
    fabric.shear = 5e4;
    fabric.bend_warp = fabric.bend_weft = 1e-6;
    fabric.bend_twist = 5e-7;
    const std::vector<double> areas = node_areas(garment);
    VectorXd q(3 * n), load = VectorXd::Zero(3 * n);
    for (int i = 0; i < n; ++i) {
        const double x = a * std::asinh((mesh.points[i].x() - length / 2) / a);
        q.segment<3>(3 * i) << x + 0.5, mesh.points[i].y(), a * (std::cosh(x / a) - std::cosh(0.5 / a));
        load[3 * i + 2] = -areas[i];
    }
    Freedoms freedoms(q);
    for (int i = 0; i < n; ++i)
        if (std::abs(mesh.points[i].x() - length / 2) > length / 2 - 1e-9)
            for (int c = 0; c < 3; ++c)
                freedoms.hold(3 * i + c, q[3 * i + c]);
    freedoms.number();
    // Away from the answer, so that staying put is not passing.
    for (int i = 0; i < n; ++i)
        if (freedoms.of[3 * i + 2] >= 0) q[3 * i + 2] *= 0.97;
    const StaticResult r = solve_static(
        {stretch_term(make_stretch(garment, {fabric}), n), bend_term(make_bending(garment, {fabric}), n)},
        load, freedoms, q);
    REQUIRE(r.converged);
    CHECK(r.stable);
    double sag = 0;
    for (int i = 0; i < n; ++i)
        sag = std::max(sag, -r.q[3 * i + 2]);
    CHECK(sag == Approx(0.5026333).epsilon(1e-3));
}
