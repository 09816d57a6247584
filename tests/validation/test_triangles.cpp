// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth by triangles (Baraff and Witkin) against its own theory, and where hinges are off.

#include "draping/energy/triangles.h"

#include "draping/cloth.h"
#include "draping/solve/implicit.h"
#include "tests/support/energy_checks.h"
#include "tests/support/free_springs.h"
#include "tests/support/plain_fabric.h"
#include "tests/support/plates.h"
#include "tests/support/pulled_square.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;
using Eigen::VectorXd;

namespace {

constexpr double pi = std::numbers::pi;

Fabric orthotropic() {
    Fabric f;
    f.name = "orthotropic";
    f.stretch_warp = 1000;
    f.stretch_weft = 600;
    f.shear = 40;
    f.bend_warp = f.bend_weft = 1e-9;
    f.bend_twist = 5e-10;
    return f;
}

/// A unit square with its warp along x turned by `angle`, moved by `map`: its energy, and what the nodes resist the
/// motion `by` with, N m per unit of it.
struct Square {
    FlatMesh mesh = unit_square();
    Garment garment;
    TriangleCloth cloth;

    explicit Square(double angle)
        : garment(garment_of(mesh, 0.5 * pi + angle)), cloth(garment, {orthotropic()}) {}

    template <class Map>
    Points places(const Map& map) const {
        Points x;
        for (const Vec2& p : mesh.points) x.push_back(map(p));
        return x;
    }
    template <class Map>
    double pull(const Map& map, double at) const {
        VectorXd g = VectorXd::Zero(3 * mesh.points.size());
        cloth.add_gradient(places([&](const Vec2& p) { return map(p, at); }), g);
        Points by;
        const double step = 1e-5;
        for (const Vec2& p : mesh.points) by.push_back((map(p, at + step) - map(p, at - step)) / (2 * step));
        return g.dot(flat(by));
    }
};

/// Stiffness of a square that is pulled by little at an angle to its warp.
double stiffness_at(double angle) {
    const Garment garment = garment_of(unit_square(), 0.5 * pi + angle);
    const auto model = std::make_shared<TriangleCloth>(garment, std::vector<Fabric>{orthotropic()});
    const double stress = 1e-2;
    return stress / pulled_strain(model_term(model, garment.node_count), stress).x();
}

} // namespace

TEST_CASE("triangles: pulled along one yarn, along both, and sheared in a frame", "[validation]") {
    const Square square(0); // warp along x
    for (const double s : {0.9, 1.01, 1.1, 1.3}) {
        INFO("stretch " << s);
        const auto uniaxial = [](const Vec2& p, double a) { return Vec3(a * p.x(), p.y(), 0); };
        CHECK(square.pull(uniaxial, s) == Approx(1000 * (s - 1)).epsilon(1e-6));
        // Nothing pulls across: no Poisson effect.
        const auto across = [&](const Vec2& p, double b) { return Vec3(s * p.x(), b * p.y(), 0); };
        CHECK(std::abs(square.pull(across, 1)) < 1e-9);
        const auto both = [&](const Vec2& p, double a) { return Vec3(a * p.x(), a * p.y(), 0); };
        CHECK(square.pull(both, s) == Approx(1600 * (s - 1)).epsilon(1e-6));
    }
    for (const double angle : {0.05, 0.3, 0.8}) {
        INFO("frame sheared by " << angle);
        const auto frame = [](const Vec2& p, double a) {
            return Vec3(p.x() + p.y() * std::sin(a), p.y() * std::cos(a), 0);
        };
        CHECK(std::abs(square.pull(frame, angle)) == Approx(40 * angle).epsilon(1e-6));
    }
}

// 1 / E(a) = cos^4 / warp + sin^4 / weft + sin^2 cos^2 / shear: orthotropic without Poisson's ratio.
TEST_CASE("triangles: stiffness at an angle to the grain", "[validation]") {
    CHECK(stiffness_at(0) == Approx(1000).epsilon(0.01));
    CHECK(stiffness_at(pi / 4) == Approx(144.58).epsilon(0.01));
    CHECK(stiffness_at(pi / 2) == Approx(600).epsilon(0.01));
}

// Flat cloth has all its conditions at 0: its second derivative is K = sum k c c^T and the matrix of its damping t K. A mode of
// frequency w then loses t w^2 of its energy per second, and implicit steps of h as much again as t = h would.
TEST_CASE("triangles: damped modes lose energy as theory says", "[validation]") {
    const FlatMesh mesh = jittered_rectangle(0.06, 0.04, 0.02, 0.2, 3);
    const Garment garment = garment_of(mesh);
    const std::vector<Fabric> fabrics{plain_fabric(500, 1e-4)};
    const std::vector<double> mass = node_masses(garment, fabrics);
    const Points rest = flat_points(mesh);
    const TriangleCloth cloth(garment, fabrics, 1e-3);
    BlockMatrix stiffness = full_matrix(int(rest.size())), damping = full_matrix(int(rest.size()));
    cloth.add_hessian(rest, HessianKind::exact, stiffness);
    cloth.add_damping_matrix(rest, 1, damping);
    const Eigen::MatrixXd k = dense(stiffness);
    CHECK((dense(damping) - 1e-3 * k).norm() < 1e-12 * 1e-3 * k.norm());

    VectorXd root(3 * mass.size()); // 1 / sqrt of the mass
    for (std::size_t i = 0; i < mass.size(); ++i) root.segment<3>(3 * i).setConstant(1 / std::sqrt(mass[i]));
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(root.asDiagonal() * k * root.asDiagonal());
    const auto flexes = [&](int mode) { // out of the plane, or in it
        double out = 0;
        for (std::size_t i = 0; i < mass.size(); ++i) out += std::pow(modes.eigenvectors()(3 * i + 2, mode), 2);
        return out > 0.5;
    };
    // The six slowest are rigid motions. The slowest and the fastest of either kind: bending, shear and stretch.
    const int all = int(modes.eigenvalues().size());
    std::array<int, 4> chosen{-1, -1, -1, -1};
    for (int mode = 6; mode < all; ++mode) {
        if (chosen[flexes(mode)] < 0) chosen[flexes(mode)] = mode;
        chosen[2 + flexes(mode)] = mode;
    }
    for (const int mode : chosen) {
        REQUIRE(mode >= 6);
        const double w = std::sqrt(modes.eigenvalues()[mode]), h = 5e-3 / w, damping_time = 0.04 / w;
        INFO("a mode of " << w << " rad/s " << (flexes(mode) ? "out of the plane" : "in the plane"));
        FreeCloth problem(std::make_unique<TriangleCloth>(garment, fabrics, damping_time), mass);
        NoContact response;
        ImplicitStepper stepper(problem, response, {h, 0, 1e9});
        Moving moving{rest, rest};
        flat(moving.velocity) = 1e-6 * w * (root.asDiagonal() * modes.eigenvectors().col(mode));
        const auto energy = [&] { return problem.value(moving.x) + kinetic_energy(mass, moving); };
        const double start = energy(), rate = (damping_time + h) * w * w;
        const int steps = int(std::lround(6 * pi / (w * h))); // of whole swings: it is lost where it moves
        for (int i = 0; i < steps; ++i) stepper.step(moving, {});
        CHECK(std::log(start / energy()) == Approx(rate * steps * h).epsilon(0.02));
    }
}
