// SPDX-License-Identifier: GPL-3.0-or-later
// A disc with a sector cut out and its cut sewn up is a cone: a circle of radius r keeps its length (2 pi -
// deficit) r, so that the half angle has sine 1 - deficit / 2 pi. Its curvature is cos / (r sin) across the
// generators, so that bending holds pi D cos cot log(outer / inner) in all.

#include "draping/cloth.h"
#include "draping/solve/settle.h"

#include "tests/support/plain_fabric.h"
#include "tests/support/sewn_sector.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double pi = std::numbers::pi;

Fabric paper() {
    Fabric f = plain_fabric(2000, 1e-5);
    f.shear = 1000;
    f.compression = 1;
    return f;
}

} // namespace

TEST_CASE("a sewn sector of a disc is a cone", "[validation]") {
    for (const auto& [deficit, half_angle, energy] :
         {std::array{30.0, 66.44353569, 0.54739872}, {90, 48.59037789, 1.83259571}, {180, 30, 4.71238898}}) {
        const double angle = (360 - deficit) * pi / 180;
        const Sector s = sewn_sector(angle, 3);
        const Barrier unused{0.5e-3, 0.5e-4, 1e6};
        ClothProblem problem(s.garment, {paper()}, {}, {unused, unused, false});
        Points x = rough_cone(s, angle, half_angle + 4);
        SettleOptions options;
        options.tolerance = 1e-5;
        Cholesky factor;
        REQUIRE(settle(problem, x, factor, options).end == SettleEnd::settled);
        INFO("deficit " << deficit);
        const std::vector<double> angles = generator_angles(s, x);
        REQUIRE(!angles.empty());
        for (double a : angles)
            CHECK(a == Approx(half_angle).margin(0.5));
        CHECK(bend_value(problem.sheet()->bending, x) ==
              Approx(1e-5 * energy * std::log(Sector::outer / Sector::inner)).epsilon(0.03));
    }
}
