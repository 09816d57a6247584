// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Time of impact of two moving simplices by conservative advancement: as additive continuous collision
// detection (Li, Kaufman, Jiang: Codimensional Incremental Potential Contact, 2021, section 5), with the
// closing speed bounded along the line of the nearest points (Mirtich 1996) rather than by the lengths of the
// motions. Sliding and rotation then cost nothing, and each step is Newton's on the distance, from the safe
// side.

#include "geometry/types.h"

namespace toile {

/// Four points at the start of a step and how far each moves during it.
struct Motion {
    std::array<Vec3, 4> x;
    std::array<Vec3, 4> dx;
};

struct ToiOptions {
    double keep = 0.1;       ///< fraction of the starting distance (less min_distance) to be kept, in (0, 1)
    double min_distance = 0; ///< metres; the pair never comes nearer than this
    int max_iterations = 10000;
};

/// A t in [0, 1] such that moving by t * dx keeps the pair's distance above
/// min_distance + keep * (start distance - min_distance) all the way. Conservative: never later than the
/// truth, and the distance at a t below 1 is within 5 % of what is to be kept (unless max_iterations ended
/// the search before, as they may where a pair touches without closing speed). Distances count as smaller by
/// a bound on all rounding: 6 epsilon of the largest coordinate, for storing x + t * dx, and 26 epsilon of
/// the longest difference between the points or their motions; at least 8 epsilon of the largest coordinate.
/// So no contact is missed, whatever the doubles, and a pair that comes nearer than this counts as touching.
/// 0 when the pair starts at or below min_distance, and when the motion is not finite.
double time_of_impact_point_triangle(const Motion& m, const ToiOptions& options); ///< x = p, a, b, c
double time_of_impact_edge_edge(const Motion& m, const ToiOptions& options);      ///< x = a0, a1, b0, b1

} // namespace toile
