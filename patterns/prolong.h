// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patterns/triangulate.h"

namespace toile {

/// Barycentric weights of every point in `queries` (points of `fine`, all of one panel) on that panel's
/// coarse triangles: the one that contains it, or the nearest, whose weights are then cut off at
/// [-0.25, 1.25].
std::vector<Interpolation> interpolate(const FlatLevel& coarse, int panel, const std::vector<Vec2>& queries);

} // namespace toile
