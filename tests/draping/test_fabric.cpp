// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fabric/fabric.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <set>

using namespace toile;

TEST_CASE("there is a preset for every name that is promised", "[fabric]") {
    for (const char* name : {"poplin", "denim", "silk", "wool", "linen", "leather", "jersey", "rib"})
        CHECK(fabric_preset(name).name == name);
    CHECK(fabric_presets().size() == 8);
    CHECK_THROWS_WITH(fabric_preset("velvet"),
                      "there is no fabric \"velvet\"; the presets are poplin, denim, silk, wool, linen, leather, "
                      "jersey, rib");
}

TEST_CASE("every preset is a cloth that can exist", "[fabric]") {
    for (const Fabric& f : fabric_presets()) {
        INFO(f.name);
        CHECK((f.density > 0.03 && f.density < 0.9));
        CHECK((f.thickness > 0.05e-3 && f.thickness < 2e-3));
        // Fibres weigh about 1300 to 1500 kg/m3, and a cloth is 15 to 50 % fibre.
        CHECK((f.density / f.thickness > 200 && f.density / f.thickness < 800));
        CHECK((f.stretch_warp >= f.stretch_weft && f.stretch_weft > 0));
        CHECK((f.poisson >= 0 && f.poisson < 0.5));
        CHECK(f.poisson * f.poisson * f.stretch_weft < f.stretch_warp); // positive definite
        CHECK((f.shear > 0 && f.shear < f.stretch_warp));
        CHECK((f.bend_warp > 0 && f.bend_weft > 0 && f.bend_twist > 0));
        CHECK((f.bend_poisson >= 0 && f.bend_poisson < 0.5));
        CHECK((f.compression > 0 && f.compression <= 1));
        CHECK((f.friction > 0.1 && f.friction < 0.7));
        CHECK((f.cloth_friction > 0.1 && f.cloth_friction < 0.7));
        CHECK((f.limit_warp >= 0.01 && f.limit_weft >= f.limit_warp));
        CHECK((f.limit_shear > 0.05 && f.limit_shear < 0.8));
        CHECK(f.source.size() > 20);
        // 5 to 95 % of the 617 fabrics measured by Feng 2022 have a bending length of 1.06 to 3.29 cm.
        const double length = std::cbrt(f.bend_warp / (9.81 * f.density));
        CHECK((length > 0.0106 && length < 0.0329));
        // Bent at 45 degrees, a cloth is between soft and stiff as its yarns are (0.5 to 2 times).
        const double c = f.bend_poisson * std::sqrt(f.bend_warp * f.bend_weft);
        const double bias = (f.bend_warp + f.bend_weft + 2 * c + 4 * f.bend_twist) / 4;
        CHECK((bias > 0.5 * f.bend_weft && bias < 2 * f.bend_warp));
        // A metre of it, hung up, stays within its limit.
        CHECK(9.81 * f.density / f.stretch_weft < f.limit_weft);
    }
}

TEST_CASE("presets are ordered as a tailor would order them", "[fabric]") {
    const auto ascending = [](double Fabric::*value, std::initializer_list<const char*> names) {
        double last = 0;
        for (const char* name : names) {
            INFO(name);
            CHECK(fabric_preset(name).*value > last);
            last = fabric_preset(name).*value;
        }
    };
    ascending(&Fabric::density, {"silk", "poplin", "jersey", "linen", "wool", "rib", "denim", "leather"});
    ascending(&Fabric::bend_warp, {"silk", "poplin", "wool", "linen", "denim", "leather"});
    ascending(&Fabric::thickness, {"silk", "poplin", "linen", "denim", "leather"});
    ascending(&Fabric::stretch_weft, {"jersey", "rib", "wool", "silk", "poplin", "linen", "leather"});
    ascending(&Fabric::limit_weft, {"linen", "poplin", "wool", "leather", "jersey", "rib"});
    ascending(&Fabric::limit_shear, {"leather", "denim", "poplin", "linen", "wool", "silk", "jersey"});
}

TEST_CASE("knits have curves of stretch, soft first and stiff later, up to their limits; wovens a number", "[fabric]") {
    for (const Fabric& f : fabric_presets()) {
        INFO(f.name);
        const bool knit = f.name == "jersey" || f.name == "rib";
        CHECK(f.curve_warp.empty() != knit);
        CHECK(f.curve_weft.empty() != knit);
        if (!knit) continue;
        CHECK(f.curve_warp.back().stretch == f.limit_warp);
        CHECK(f.curve_weft.back().stretch == f.limit_weft);
        const auto tension = [](const std::vector<StretchPoint>& points, double s) {
            return evaluate(stretch_curve(points), s).tension;
        };
        CHECK(f.stretch_warp == Approx(tension(f.curve_warp, 0.1) / 0.1));
        CHECK(f.stretch_weft == Approx(tension(f.curve_weft, 0.1) / 0.1));
        for (const auto& points : {f.curve_warp, f.curve_weft})
            for (std::size_t k = 2; k < points.size(); ++k)
                CHECK((points[k].tension - points[k - 1].tension) / (points[k].stretch - points[k - 1].stretch) >
                      (points[k - 1].tension - points[k - 2].tension) / (points[k - 1].stretch - points[k - 2].stretch));
        // Along the courses it gives more, at any tension.
        for (double s = 0.01; s <= f.limit_warp; s += 0.01) CHECK(tension(f.curve_weft, s) < tension(f.curve_warp, s));
    }
}
