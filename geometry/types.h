// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The vocabulary of points and triangles. SI units everywhere: metres, radians.

#include <Eigen/Core>
#include <Eigen/Geometry> // cross(): with Core alone it compiles and fails to link

#include <array>
#include <vector>

namespace toile {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat2 = Eigen::Matrix2d;
using Mat3 = Eigen::Matrix3d;

/// Indices of a triangle's corners, counter-clockwise seen from its front.
using Triangle = std::array<int, 3>;

/// Points in space. Contiguous, so that flat(points) sees them as one vector x0 y0 z0 x1 ...
using Points = std::vector<Vec3>;

inline Eigen::Map<Eigen::VectorXd> flat(Points& p) { return {p.data()->data(), Eigen::Index(3 * p.size())}; }
inline Eigen::Map<const Eigen::VectorXd> flat(const Points& p) {
    return {p.data()->data(), Eigen::Index(3 * p.size())};
}

} // namespace toile
