// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Unsigned distances between points, edges and triangles, with the weights of the nearest points.
// Degenerate triangles (a segment, a point), degenerate edges and parallel edges are handled like any other.

#include "geometry/types.h"

#include <optional>

namespace toile {

/// Nearest points of two simplices: distance squared and the barycentric weights on each.
/// Point-triangle: weight = {1 on the point; a, b, c on the corners}. Edge-edge: {1-s, s; 1-t, t}.
/// `active` says which weights may vary (bit k: corner k takes part): it names the nearest feature. A corner
/// whose bit is clear has weight 0. Where features tie, the smaller one is named.
struct Nearest {
    double squared = 0;
    std::array<double, 4> weight{}; ///< positive weights of the four points, in the order of the call
    int active = 0;
};

Nearest nearest_point_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);
Nearest nearest_edge_edge(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1);

/// Nearest point of a segment to p, as its parameter in [0, 1]; 0 for a segment of no length.
double nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b);

/// Where a segment passes through a triangle.
struct Passage {
    double along = 0; ///< of the segment, [0, 1]
    Vec3 corner;      ///< barycentric coordinates in the triangle
};

/// Where the segment a b passes through the triangle, borders included; nothing when it does not, or runs along it.
std::optional<Passage> segment_through_triangle(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q,
                                                const Vec3& r);

/// From the nearest point of the first simplex to that of the second: point - triangle point is `x` = p, a,
/// b, c, edge - edge is a0, a1, b0, b1. Differences are taken first, so that a small gap far from the origin
/// keeps its digits.
Vec3 gap_point_triangle(const Nearest& nearest, const std::array<Vec3, 4>& x);
Vec3 gap_edge_edge(const Nearest& nearest, const std::array<Vec3, 4>& x);

} // namespace toile
