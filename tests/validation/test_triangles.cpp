// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth by triangles (Baraff and Witkin) against its own theory, and where hinges are off.

#include "draping/energy/triangles.h"

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
