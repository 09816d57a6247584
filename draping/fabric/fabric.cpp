// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fabric/fabric.h"

#include <stdexcept>

namespace toile {

namespace {

constexpr double micro = 1e-6, milli = 1e-3;
constexpr double degree = 3.14159265358979323846 / 180;

// docs/fabrics.md has the references, the measured figures beside these, and how the remaining ones were chosen.

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
    f.stretch_warp = 120;
    f.compression = 1;
    f.stretch_weft = 46;
    f.poisson = 0.3;
    f.shear = 37;
    f.bend_warp = 13 * micro;
    f.bend_weft = 7.2 * micro;
    f.bend_twist = 3.7 * micro;
    f.thickness = 0.6 * milli;
    f.friction = 0.35;
    f.cloth_friction = 0.30;
    f.limit_warp = 0.25;
    f.limit_weft = 0.5;
    f.limit_shear = 45 * degree;
    f.source = "stretch and shear: between the first and the last modulus of an interlock, Wang 2011; bending: "
               "medians at 0.14-0.18 kg/m2, Feng 2022; limits: chosen";
    return f;
}

Fabric rib() {
    Fabric f;
    f.name = "rib";
    f.density = 0.276;
    f.stretch_warp = 150;
    f.compression = 1;
    f.stretch_weft = 43;
    f.poisson = 0.3;
    f.shear = 60;
    f.bend_warp = 46 * micro;
    f.bend_weft = 32 * micro;
    f.bend_twist = 10 * micro;
    f.thickness = 1.0 * milli;
    f.friction = 0.40;
    f.cloth_friction = 0.30;
    f.limit_warp = 0.35;
    f.limit_weft = 0.8;
    f.limit_shear = 45 * degree;
    f.source = "density, stretch, shear, bending: rib knit, Wang 2011; limits: chosen";
    return f;
}

} // namespace

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
