// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/strain_difference.h"
#include "tests/support/skirt.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace toile;

TEST_CASE("strains that differ alike everywhere differ by as much on any two meshes") {
    const auto coarse = test::make_skirt(48, 6, 0.16, 1.0, 0.5);
    auto fine = test::make_skirt(96, 11, 0.16, 1.0, 0.5);
    for (Vec3& p : fine.x) p.y() = 1 + 1.02 * (p.y() - 1); // 2 % along the warp
    // The chords of the two meshes are shorter than their arcs by (pi / n)^2 / 24.
    const double weft = std::pow(EIGEN_PI / 48, 2) / 24 - std::pow(EIGEN_PI / 96, 2) / 24;
    const double expected = std::sqrt((0.02 * 0.02 + weft * weft) / 2);
    CHECK(strain_difference(coarse.garment, coarse.x, fine.garment, fine.x) == Approx(expected).epsilon(1e-3));
    CHECK(strain_difference(fine.garment, fine.x, coarse.garment, coarse.x) == Approx(expected).epsilon(1e-3));
    CHECK(strain_difference(fine.garment, fine.x, fine.garment, fine.x) == 0);
}

TEST_CASE("the strain of one motion on two meshes differs the less the finer they are") {
    const auto at = [](int rows) {
        auto tube = test::make_skirt(4 * rows, rows, 0.16, 1.0, 0.5);
        for (Vec3& p : tube.x) p.y() += 0.05 * std::sin(6 * p.y()) / 6; // warp strains of 5 % cos
        return tube;
    };
    const auto difference = [&](int rows) {
        const auto a = at(rows), b = at(2 * rows);
        return strain_difference(a.garment, a.x, b.garment, b.x);
    };
    const double first = difference(8), second = difference(16);
    CHECK(first < 0.05 * 0.05);
    CHECK(second < 0.55 * first);
}

TEST_CASE("cloth gathered into a seam counts as not compressed by strain differences") {
    auto a = test::make_skirt(12, 6, 0.16, 1.0, 0.5), b = a;
    for (Vec3& p : b.x) p.y() = 1 + 0.9 * (p.y() - 1);
    b.garment.eased_triangle.assign(b.garment.triangles.size(), true);
    a.garment.eased_triangle = b.garment.eased_triangle;
    CHECK(strain_difference(a.garment, a.x, b.garment, b.x) < 1e-12);
}
