// SPDX-License-Identifier: GPL-3.0-or-later
// A tight band round a cone, as a waist is on a body: what friction has to hold is the slope of the body,
// since the band's own tension pulls it towards the narrow end. With the hoop tension of the band T, radius
// r, weight per area w and half angle a of the cone, the tension presses T / r on the axis, of which T / r
// cos a - w sin a is normal to a cone that narrows downwards and T / r sin a + w cos a along it: the band
// holds while
//     tan(a + atan(w r / T)) <= friction.
// On a cone that widens downwards the weight pulls the other way, and it holds while tan(a - atan(w r / T))
// <= friction.

#include "draping/cloth.h"
#include "draping/solve/settle.h"

#include "tests/support/flat_mesh.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double pi = std::numbers::pi, degree = pi / 180;
constexpr double waist = 0.1;    // m, radius of the cone at the middle of the band
constexpr double height = 0.03;  // m, of the band along the cone
constexpr double above = 0.4e-3; // m, from the cone to the band

/// Radius at the distance s along the cone, upwards from the middle of the band; `widens` is 1 for a cone
/// that widens upwards.
Vec3 on_cone(double angle, double widens, double round, double s, double off) {
    const double radius = waist + widens * s * std::sin(angle) + off * std::cos(angle);
    return {radius * std::cos(round), s * std::cos(angle) - widens * off * std::sin(angle),
            -radius * std::sin(round)};
}

TriMesh cone(double angle, double widens) {
    TriMesh mesh;
    const int around = 72, up = 8;
    for (int j = 0; j <= up; ++j)
        for (int i = 0; i < around; ++i)
            mesh.points.push_back(
                on_cone(angle, widens, 2 * pi * i / around, (2.0 * j / up - 1) * 2.5 * height, 0));
    for (int j = 0; j < up; ++j)
        for (int i = 0; i < around; ++i) {
            const int a = j * around + i, b = j * around + (i + 1) % around;
            mesh.triangles.push_back({a, b, b + around});
            mesh.triangles.push_back({a, b + around, a + around});
        }
    return mesh;
}

struct Band {
    Garment garment;
    Points x;
};

/// Cut to the cone and sewn to a ring, the warp all round, `strain` too short for where it is put, and with
/// as much more height as the tension takes from it.
Band band(double angle, double widens, double strain, double poisson) {
    const double length = 2 * pi * waist;
    const FlatMesh flat = jittered_rectangle(length, height, 0.0075, 0.25, 3);
    Garment open = garment_of(flat, pi / 2); // the warp along the strip
    for (int a = 0; a < open.node_count; ++a)
        for (int b = 0; b < open.node_count; ++b)
            if (flat.points[a].x() < 1e-9 && flat.points[b].x() > length - 1e-9 &&
                std::abs(flat.points[a].y() - flat.points[b].y()) < 1e-9)
                open.stitches.push_back({b, {a, a}, 0, 0, 0.01});
    // The flat shape of every triangle: what the cone has there, short by the strain.
    for (std::size_t t = 0; t < flat.triangles.size(); ++t) {
        const Triangle& v = flat.triangles[t];
        const Vec2 centre = (flat.points[v[0]] + flat.points[v[1]] + flat.points[v[2]]) / 3;
        const double radius = waist + widens * (centre.y() - height / 2) * std::sin(angle);
        Mat2 e;
        for (int k = 0; k < 2; ++k) {
            const Vec2 d = flat.points[v[k + 1]] - flat.points[v[0]];
            e.col(k) = Vec2(-d.y() / (1 - poisson * strain), d.x() * radius / waist / (1 + strain));
        }
        open.rest.edges[t] = e;
    }
    std::vector<int> node;
    Band b{close_seams(open, &node), {}};
    b.x.resize(b.garment.node_count);
    for (int i = 0; i < open.node_count; ++i)
        b.x[node[i]] =
            on_cone(angle, widens, flat.points[i].x() / waist, flat.points[i].y() - height / 2, above);
    return b;
}

struct Held {
    bool settled = false;
    double lean = 0;     ///< rad, weight against tension: atan(w r / T)
    double farthest = 0; ///< m, that any node has moved
    double sunk = 0;     ///< m, mean
};

/// Hooks hold the band at its height while it comes to rest on the cone without friction; then they are let
/// go.
Held let_go(const Fabric& fabric, double friction, double angle, double widens, double strain) {
    Band b = band(angle, widens, strain, fabric.poisson);
    ContactOptions contact;
    contact.body = contact.cloth = {0.5e-3, 0.5e-4, 1e7};
    ClothProblem problem(b.garment, {fabric}, cone(angle, widens), contact);
    problem.gravity = 9.81;
    for (int i = 0; i < b.garment.node_count; ++i)
        problem.hooks.push_back({i, b.x[i], Vec3::UnitY(), 5, 1});
    Cholesky factor;
    SettleOptions options;
    REQUIRE(settle(problem, b.x, factor, options).end == SettleEnd::settled);
    Held h;
    double pressed = 0, weight = 0; // N
    for (const Vec3& f : problem.contact().body_forces(problem.contact().active(b.x)))
        pressed += f.norm();
    for (double m : problem.node_mass())
        weight += 9.81 * m;
    h.lean = std::asin(weight * std::cos(angle) /
                       pressed); // near enough: the tension presses many times the weight
    const Points start = b.x;
    problem.hooks.clear();
    problem.rest_here(b.x, {friction}, true);
    options.max_iterations = 200; // a band that slides goes on sliding, by a millimetre in some ten iterations
    options.tolerance = 1e-5;
    h.settled = settle(problem, b.x, factor, options).end == SettleEnd::settled;
    for (std::size_t i = 0; i < start.size(); ++i) {
        h.farthest = std::max(h.farthest, (b.x[i] - start[i]).norm());
        h.sunk += (start[i].y() - b.x[i].y()) / double(start.size());
    }
    return h;
}

/// Of constant stiffness: tension is to be proportional to stretch, and how far nodes give before friction holds them is not to be
/// that of a knit's soft beginning (by its curves jersey gives 0.15 mm).
Fabric straight(const std::string& name) {
    Fabric f = fabric_preset(name);
    if (f.curve_warp.empty()) return f;
    f.curve_warp.clear();
    f.curve_weft.clear();
    f.stretch_warp = 120;
    f.stretch_weft = 46;
    return f;
}

} // namespace

TEST_CASE("a waistband holds on a cone within the angle of friction and slides off beyond it",
          "[validation]") {
    for (const auto& [name, strain] : {std::pair{"poplin", 0.006}, {"jersey", 0.12}})
        for (double widens : {1.0, -1.0}) {
            const Fabric f = straight(name);
            INFO(name << (widens > 0 ? ", narrow below" : ", narrow above"));
            for (double within : {3.0, 1.0}) {
                const Held held =
                    let_go(f, f.friction, std::atan(f.friction) - within * degree, widens, strain);
                CHECK(held.lean < 0.5 * degree); // so that the slope alone decides
                CHECK(held.settled);
                CHECK(held.farthest < 1e-4);
            }
            for (double beyond : {1.0, 3.0}) {
                const Held lost =
                    let_go(f, f.friction, std::atan(f.friction) + beyond * degree, widens, strain);
                CHECK(widens * lost.sunk > 2e-3); // towards the narrow end, until nothing pulls any more
            }
        }
}
