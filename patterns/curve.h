// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patterns/pattern.h"

namespace toile {

/// Point at curve parameter u in [0, 1].
Vec2 point_at(const Edge& edge, double u);
double length(const Edge& edge);

/// Points at equally spaced arc length from fraction t0 to t1 (either order), n >= 1 intervals, n + 1 points.
/// The points at 0 and 1 are exactly the edge's ends.
std::vector<Vec2> sample(const Edge& edge, double t0, double t1, int n);

/// Curvature bounds and extents for deciding how finely to sample: the polyline of `sample` with this many
/// intervals strays from the curve by at most `tolerance` metres.
int intervals_for_sag(const Edge& edge, double tolerance);

/// Signed area of a closed loop, positive counter-clockwise, curves included.
double signed_area(const Loop& loop);

} // namespace toile
