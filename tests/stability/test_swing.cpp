// SPDX-License-Identifier: GPL-3.0-or-later
// Implicit Euler: a step divides the amplitude of a swing by sqrt(1 + w^2 h^2).

#include "draping/stability/boundary.h"
#include "tests/stability/scenes.h"

#include <complex>
#include <numbers>

using namespace toile;
using namespace toile::test;

TEST_CASE("stability: half of the amplitude is left by steps of 0.2262 of a radian") {
    const double z = swing_step(1, 0.5);
    CHECK(z == Approx(0.2262).epsilon(1e-3));
    CHECK(std::pow(1 + z * z, -std::numbers::pi / z) == Approx(0.5).epsilon(1e-9));
    CHECK(swing_step(7, 0.5) == Approx(z / 7));
    const double z2 = bdf2_swing_step(1, 0.5);
    CHECK(z2 == Approx(1.5).epsilon(0.01));
    CHECK(std::pow(std::abs(2.0 - std::sqrt(std::complex<double>(1, 2 * z2))), -2 * std::numbers::pi / z2) == Approx(0.5).epsilon(1e-9));
    CHECK(std::pow(bdf2_swing_step(1, 0.999), 3) == Approx(-2 * std::log(0.999) / std::numbers::pi).epsilon(0.02)); // exp(-pi z^3 / 2) for short ones
    CHECK(swing_step(1, 0.99) == Approx(-std::log(0.99) / std::numbers::pi).epsilon(1e-3)); // exp(-pi z) for short ones
}

TEST_CASE("stability: implicit steps take a swing away from where theory says and not before") {
    // Baraff and Witkin's triangles have the very modulus of the wave; 3 %: the wave of a dozen edges is that much slower at most, and jitter
    // puts a percent of its energy into faster motions.
    CHECK(check_boundary(stability_scene(Method::triangles, "swing"), stability_meshes(2), {1e4}, 0.94, 1.06) == 9);
    // Springs along the edges of a mesh have a Poisson effect that the start does not: up to a sixth of the energy is in motions across.
    CHECK(check_boundary(stability_scene(Method::springs_implicit, "swing"), stability_meshes(0), {1e4, 1e6}, 0.75, 1.25) == 6);
}
