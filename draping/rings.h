// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Panels that, sewn to each other, go round a vertical axis: what tells a skirt, wherever its file lays it flat.

#include "geometry/tri_mesh.h"
#include "sewing/garment.h"

namespace toile {

/// The angle at which a point lies round the vertical through `axis`, rad, in (-pi, pi], from x toward z.
double azimuth(const Vec3& point, const Vec3& axis);

/// The middle of every panel of an open garment, by area.
std::vector<Vec3> panel_middles(const Garment& garment, const Points& x);

/// By seam, how many turns round the axis its far side is ahead: on the way from the middle of the panel of its `a` past both of
/// its sides, always the shorter way round, to the middle of the panel of its `b`. An azimuth that goes on across seams is
/// 2 pi times that larger on the side of `a`.
std::vector<int> turns_at_seams(const Garment& garment, const Points& x, const Vec3& axis);

/// By panel, what of an open garment hangs round the body as a skirt but has the body (arms and hands) between the sides of
/// some of its seams (`split`, by seam): rings of panels beside each other that go round the body and are sewn to something above them, below
/// the armpits (m, their height), with all that hangs from them. All false when there are none.
std::vector<bool> skirt_round_arms(const Garment& garment, const Points& x, const TriMesh& body, const std::vector<char>& split,
                                   double armpit);

} // namespace toile
