// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/fabric/fabric.h"

namespace toile::test {

/// Cloth of 0.15 kg/m2 that is alike along warp and weft, without limits; `stretch` in N/m, `bend` in N m.
inline Fabric plain_fabric(double stretch, double bend) {
    Fabric f;
    f.name = "plain";
    f.density = 0.15;
    f.stretch_warp = f.stretch_weft = stretch;
    f.shear = 50;
    f.bend_warp = f.bend_weft = bend;
    f.bend_twist = bend / 2;
    return f;
}

} // namespace toile::test
