// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The few formulas of plane geometry that triangulation needs everywhere.

#include "geometry/types.h"

#include <algorithm>
#include <cmath>

namespace toile {

/// Positive when b is counter-clockwise of a.
inline double cross(const Vec2& a, const Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}

inline double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
    const double s = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return (a + s * (b - a) - p).norm();
}

/// Panel coordinates to (weft, warp): the warp turns to y. `grain` as in Panel.
inline Mat2 to_grain(double grain) {
    if (grain == double(EIGEN_PI / 2)) return Mat2::Identity(); // exactly, not within rounding
    Mat2 m;
    m << std::sin(grain), -std::cos(grain), std::cos(grain), std::sin(grain);
    return m;
}

} // namespace toile
