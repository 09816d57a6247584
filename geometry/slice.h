// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Horizontal sections of a surface and the length of a tape measure round them.

#include "geometry/tri_mesh.h"

namespace toile {

/// The section of the surface at height y: closed loops of points (x, z). A border or a crowded edge may leave a
/// loop open; it is then closed by its chord. Points at exactly y count as above.
std::vector<std::vector<Vec2>> slice(const TriMesh& mesh, double y);

/// The convex hull, counter-clockwise, without points on its edges.
std::vector<Vec2> convex_hull(std::vector<Vec2> points);

/// Length around the convex hull: what a tape measure reads. Metres.
double hull_length(const std::vector<Vec2>& points);

/// Area and centroid of a closed loop; the sign of the area is dropped.
struct LoopArea {
    double area = 0;
    Vec2 centroid = Vec2::Zero();
};
LoopArea loop_area(const std::vector<Vec2>& loop);

} // namespace toile
