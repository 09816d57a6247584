// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_placement.h"

#include "io/read_edge.h"

namespace toile {

Vec3 read_vector(const JsonView& v, double metres) {
    v.expect_array(3, 3);
    Vec3 t;
    for (int k = 0; k < 3; ++k)
        t[k] = read_length(v.at(k, "coordinate"), metres);
    return t;
}

Mat3 read_rotation(const JsonView& v) {
    v.expect_array(3, 3);
    const auto radians = [&](int k) { return v.at(k, "angle").number(-1e6, 1e6) * (EIGEN_PI / 180); };
    const Vec3 r(radians(0), radians(1), radians(2));
    using Turn = Eigen::AngleAxisd;
    return (Turn(r.z(), Vec3::UnitZ()) * Turn(r.y(), Vec3::UnitY()) * Turn(r.x(), Vec3::UnitX()))
        .toRotationMatrix();
}

} // namespace toile
