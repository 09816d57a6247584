// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Boards and what lies on them, tilted.

#include "draping/contact/contact.h"

#include <Eigen/Geometry>

namespace toile::test {

/// Half a millimetre from body and cloth alike, 1 MPa/m.
inline ContactOptions light_barriers() {
    ContactOptions o;
    o.body = o.cloth = {0.5e-3, 0.5e-4, 1e6};
    return o;
}

/// About the z axis by `angle` (rad), so that what lies on y = 0 slopes down along x.
inline Points turned(Points points, double angle) {
    const Mat3 turn = Eigen::AngleAxisd(-angle, Vec3::UnitZ()).toRotationMatrix();
    for (Vec3& p : points) p = turn * p;
    return points;
}

} // namespace toile::test
