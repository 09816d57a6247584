// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Grain on cloth that has no flat pattern: a direction laid on the surface.

#include "geometry/types.h"

namespace toile {

/// Edges a and b of a triangle (from corner 0 to 1 and to 2) by weft and warp, as RestShape has them. The warp is `warp` (not
/// zero) laid into the triangle's plane; where the plane is across it, the axis of space that lies best in the plane is.
Mat2 edges_in_grain(const Vec3& a, const Vec3& b, const Vec3& warp);

/// The direction in space of what is (0, 1) on the flat triangle of edges `a_flat` and `b_flat`; zero when that has no area.
Vec3 flat_warp(const Vec3& a, const Vec3& b, const Vec2& a_flat, const Vec2& b_flat);

} // namespace toile
