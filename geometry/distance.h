// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Unsigned distances between points, edges and triangles, with the weights of the nearest points.

#include "geometry/types.h"

namespace toile {

/// Nearest points of two simplices: distance squared and the barycentric weights on each.
/// Point-triangle: weight = {1 on the point; a, b, c on the corners}. Edge-edge: {1-s, s; 1-t, t}.
/// `active` says which weights may vary (bit k: corner k takes part): it names the nearest feature.
struct Nearest {
    double squared = 0;
    std::array<double, 4> weight{}; ///< positive weights of the four points, in the order of the call
    int active = 0;
};

Nearest nearest_point_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);
Nearest nearest_edge_edge(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1);

/// Nearest point of a segment to p, as its parameter in [0, 1].
double nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b);

} // namespace toile
