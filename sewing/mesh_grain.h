// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth that has no flat pattern: a mesh as a garment, and its grain, a direction laid on the surface.

#include "sewing/garment.h"

namespace toile {

/// Edges a and b of a triangle (from corner 0 to 1 and to 2) by weft and warp, as RestShape has them. The warp is `warp` (not
/// zero) laid into the triangle's plane; where the plane is across it, the axis of space that lies best in the plane is.
Mat2 edges_in_grain(const Vec3& a, const Vec3& b, const Vec3& warp);

/// The direction in space of what is (0, 1) on the flat triangle of edges `a_flat` and `b_flat`; zero when that has no area.
Vec3 flat_warp(const Vec3& a, const Vec3& b, const Vec2& a_flat, const Vec2& b_flat);

/// The mesh as a garment of one panel, "cloth", without seams: `points` vertices that are nodes, and `edges` of every triangle at
/// rest as RestShape has them.
Garment mesh_garment(const std::vector<Triangle>& triangles, int points, std::vector<Mat2> edges);

} // namespace toile
