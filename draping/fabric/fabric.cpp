// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fabric/fabric.h"

#include <stdexcept>

namespace toile {

namespace {

constexpr double micro = 1e-6, milli = 1e-3;
constexpr double degree = 3.14159265358979323846 / 180;

double standing_for(const std::vector<StretchPoint>& points) {
    check_points(points);
    membrane_curve(points); // or it would be refused only when it is draped
    return secants(stretch_curve(points), secant_stretch).by_tension;
}

// docs/fabrics.md has the references, the measured figures beside these, and how the remaining ones were chosen.

/// Wang 2011 has the stiffness of a strip, stress over Green's strain, flat and at a stretch of 1/6, and linear between; here up
/// to `limit`.
std::vector<StretchPoint> measured(double flat, double at_sixth, double limit) {
    std::vector<StretchPoint> points{{}};
    for (const double s : {0.01, 0.03, 0.06, 0.1, 1.0 / 6, 0.25, 0.35, 0.5, 0.8})
        if (s <= limit) points.push_back({s, (1 + s) * (flat + (at_sixth - flat) * 6 * s) * s * (1 + s / 2)});
    return points;
}

Fabric poplin() {
    Fabric f;
    f.name = "poplin";
    f.density = 0.12;
    f.stretch_warp = 2000;
    f.stretch_weft = 1600;
    f.poisson = 0.243;
    f.shear = 45;
    f.bend_warp = 7.7 * micro;
    f.bend_weft = 5.2 * micro;
    f.bend_twist = 2.9 * micro;
    f.thickness = 0.25 * milli;
    f.friction = 0.30;
    f.cloth_friction = 0.30;
    f.limit_warp = 0.02;
    f.limit_weft = 0.03;
    f.limit_shear = 25 * degree;
    f.source = "stretch: plain weave of 0.128 kg/m2, Wang 2011; bending: medians at 0.10-0.14 kg/m2, Feng 2022; "
               "Poisson ratio: cotton, Penava 2014; shear: range of shirtings, Kawabata 1980; limits: chosen";
    return f;
}

Fabric denim() {
    Fabric f;
    f.name = "denim";
    f.density = 0.324;
    f.stretch_warp = 2500;
    f.stretch_weft = 1500;
    f.poisson = 0.2;
    f.shear = 60;
    f.bend_warp = 97 * micro;
    f.bend_weft = 64 * micro;
    f.bend_twist = 33 * micro;
    f.thickness = 0.6 * milli;
    f.friction = 0.30;
    f.cloth_friction = 0.30;
    f.limit_warp = 0.015;
    f.limit_weft = 0.025;
    f.limit_shear = 20 * degree;
    f.source = "density, shear, bending: 11 oz denim, Wang 2011; stretch and limits: denim without elastane, "
               "chosen between that sample and the woven trousers";
    return f;
}

Fabric silk() {
    Fabric f;
    f.name = "silk";
    f.density = 0.06;
    f.stretch_warp = 1500;
    f.stretch_weft = 1200;
    f.poisson = 0.2;
    f.shear = 20;
    f.bend_warp = 3.0 * micro;
    f.bend_weft = 2.9 * micro;
    f.bend_twist = 1.3 * micro;
    f.thickness = 0.12 * milli;
    f.friction = 0.25;
    f.cloth_friction = 0.30;
    f.limit_warp = 0.02;
    f.limit_weft = 0.03;
    f.limit_shear = 35 * degree;
    f.source = "bending: medians at 0.05-0.08 kg/m2, Feng 2022; shear: range of silks, Kawabata 1980; stretch, "
               "friction and limits: chosen";
    return f;
}

Fabric wool() {
    Fabric f;
    f.name = "wool";
    f.density = 0.235;
    f.stretch_warp = 1200;
    f.stretch_weft = 900;
    f.poisson = 0.277;
    f.shear = 40;
    f.bend_warp = 16 * micro;
    f.bend_weft = 12 * micro;
    f.bend_twist = 7.0 * micro;
    f.thickness = 0.57 * milli;
    f.friction = 0.35;
    f.cloth_friction = 0.30;
    f.limit_warp = 0.03;
    f.limit_weft = 0.04;
    f.limit_shear = 32 * degree;
    f.source = "density, thickness, Poisson ratio: wool, Penava 2014; bending: medians at 0.20-0.24 kg/m2, Feng "
               "2022; shear: range of suitings, Kawabata 1980; stretch and limits: chosen";
    return f;
}

Fabric linen() {
    Fabric f;
    f.name = "linen";
    f.density = 0.19;
    f.stretch_warp = 3500;
    f.stretch_weft = 3000;
    f.poisson = 0.15;
    f.shear = 40;
    f.bend_warp = 30 * micro;
    f.bend_weft = 18 * micro;
    f.bend_twist = 10 * micro;
    f.thickness = 0.4 * milli;
    f.friction = 0.30;
    f.cloth_friction = 0.30;
    f.limit_warp = 0.015;
    f.limit_weft = 0.02;
    f.limit_shear = 28 * degree;
    f.source = "bending: upper quartiles at 0.17-0.21 kg/m2, Feng 2022 (flax is a stiff fibre); stretch, shear, "
               "friction and limits: chosen";
    return f;
}

Fabric leather() {
    Fabric f;
    f.name = "leather";
    f.density = 0.60;
    f.stretch_warp = 5000;
    f.stretch_weft = 4000;
    f.poisson = 0.4;
    f.shear = 1600;
    f.bend_warp = 164 * micro;
    f.bend_weft = 102 * micro;
    f.bend_twist = 40 * micro;
    f.bend_poisson = 0.3;
    f.thickness = 0.8 * milli;
    f.friction = 0.45;
    f.cloth_friction = 0.30;
    f.limit_warp = f.limit_weft = 0.05;
    f.limit_shear = 6 * degree;
    f.source = "bending: median and upper quartile at 0.6-0.9 kg/m2, Feng 2022; stretch: 6 MPa at 0.8 mm; shear: "
               "that of a sheet without grain; friction and limits: chosen";
    return f;
}

Fabric jersey() {
    Fabric f;
    f.name = "jersey";
    f.density = 0.17;
    f.limit_warp = 0.35;
    f.limit_weft = 0.5;
    set_warp_curve(f, measured(34.5, 348, f.limit_warp));
    set_weft_curve(f, measured(16.6, 35.3, f.limit_weft));
    f.compression = 1;
    f.poisson = 0.3;
    f.shear = 37;
    f.bend_warp = 13 * micro;
    f.bend_weft = 7.2 * micro;
    f.bend_twist = 3.7 * micro;
    f.thickness = 0.6 * milli;
    f.friction = 0.35;
    f.cloth_friction = 0.30;
    f.limit_shear = 45 * degree;
    f.source = "stretch curves up to 1/6 and shear: an interlock, Wang 2011, beyond 1/6 continued by the same law; bending: "
               "medians at 0.14-0.18 kg/m2, Feng 2022; limits: chosen";
    return f;
}

Fabric rib() {
    Fabric f;
    f.name = "rib";
    f.density = 0.276;
    f.limit_warp = 0.35;
    f.limit_weft = 0.8;
    set_warp_curve(f, measured(65.2, 254.6, f.limit_warp));
    set_weft_curve(f, measured(42.9, 52.2, f.limit_weft));
    f.compression = 1;
    f.poisson = 0.3;
    f.shear = 60;
    f.bend_warp = 46 * micro;
    f.bend_weft = 32 * micro;
    f.bend_twist = 10 * micro;
    f.thickness = 1.0 * milli;
    f.friction = 0.40;
    f.cloth_friction = 0.30;
    f.limit_shear = 45 * degree;
    f.source = "density, stretch curves up to 1/6, shear, bending: rib knit, Wang 2011, beyond 1/6 continued by the same law; "
               "limits: chosen";
    return f;
}

} // namespace

void set_warp_curve(Fabric& fabric, std::vector<StretchPoint> points) {
    fabric.stretch_warp = standing_for(points);
    fabric.curve_warp = std::move(points);
}

void set_weft_curve(Fabric& fabric, std::vector<StretchPoint> points) {
    fabric.stretch_weft = standing_for(points);
    fabric.curve_weft = std::move(points);
}

const std::vector<Fabric>& fabric_presets() {
    static const std::vector<Fabric> presets = {poplin(), denim(), silk(),   wool(),
                                                linen(),  leather(), jersey(), rib()};
    return presets;
}

const Fabric& fabric_preset(const std::string& name) {
    std::string names;
    for (const Fabric& f : fabric_presets()) {
        if (f.name == name) return f;
        names += (names.empty() ? "" : ", ") + f.name;
    }
    throw std::invalid_argument("there is no fabric \"" + name + "\"; the presets are " + names);
}

} // namespace toile
