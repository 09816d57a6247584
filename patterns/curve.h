// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patterns/pattern.h"

namespace toile {

/// Point at curve parameter u in [0, 1]; exactly the edge's ends at 0 and 1.
Vec2 point_at(const Edge& edge, double u);

/// Direction of travel at curve parameter u, unit length; zero where the curve stands still (a cusp, an edge
/// of no length).
Vec2 tangent_at(const Edge& edge, double u);

/// Arc length, to about 1e-12 of itself.
double length(const Edge& edge);

/// Sum over the edges.
double length(const Loop& loop);

/// Points at equally spaced arc length from fraction t0 to t1 (either order), n >= 1 intervals, n + 1 points.
/// The points at 0 and 1 are exactly the edge's ends.
std::vector<Vec2> sample(const Edge& edge, double t0, double t1, int n);

/// Points at the given fractions of arc length, those at 0 and 1 exactly the edge's ends.
std::vector<Vec2> points_at(const Edge& edge, const std::vector<double>& fractions);

/// How finely to sample: the polyline of `sample` over the whole edge with this many intervals strays from
/// the curve by at most `tolerance` metres (at most 4096 intervals).
int intervals_for_sag(const Edge& edge, double tolerance);

/// The edge walked the other way.
Edge reversed(const Edge& edge);

/// An arc in the terms of its circle: it starts at `start` in direction `first`, turns by `angle` rad
/// (positive counter-clockwise) at `radius`. A radius below half the chord is taken as half the chord.
struct ArcTurn {
    double radius = 0;
    double angle = 0;
    Vec2 first = Vec2::Zero();
};
ArcTurn turn_of(const Edge& edge, const Arc& arc);

/// Signed area of a closed loop, positive counter-clockwise, curves included.
double signed_area(const Loop& loop);

} // namespace toile
