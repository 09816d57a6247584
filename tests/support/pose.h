// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/tri_mesh.h"

#include <algorithm>
#include <cmath>

namespace toile::test {

/// The built-in form of standard measures, its arms raised from their A pose by `angle`, rad, about the shoulders; the
/// skin between arm and chest goes with smooth weights.
inline Points with_arms_raised(const TriMesh& form, double angle) {
    const Vec2 shoulder(0.175, 1.34), arm(0.68, -0.733); // m, and the way of the arm from there
    const auto smooth = [](double t) {
        t = std::clamp(t, 0.0, 1.0);
        return t * t * (3 - 2 * t);
    };
    Points moved = form.points;
    for (Vec3& p : moved) {
        const double side = p.x() < 0 ? -1 : 1;
        const Vec2 q = Vec2(side * p.x(), p.y()) - shoulder;
        const double along = q.dot(arm), off = along > 0 ? std::abs(q.x() * arm.y() - q.y() * arm.x()) : q.norm();
        const double turn = angle * smooth((along + 0.06) / 0.14) * (1 - smooth((off - 0.08) / 0.06));
        const Vec2 r = shoulder + Eigen::Rotation2Dd(turn) * q;
        p = {side * r.x(), r.y(), p.z()};
    }
    return moved;
}

} // namespace toile::test
