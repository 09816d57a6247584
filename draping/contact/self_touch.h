// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Where cloth cannot touch itself, by cones of normals and boxes (Volino and Magnenat-Thalmann 1994, "Efficient
// self-collision detection on smoothly discretized surface animations using geometrical shape regularity").

#include "geometry/tri_mesh.h"

namespace toile {

/// Whether places of the cloth that are not next to each other may come within `reach` (m). The cloth is cut into patches whose
/// normals lie within 25 degrees of one direction. A patch, and two that share a node and whose normals lie within 75 degrees of one
/// direction, can meet themselves only by crossing their own outline, which is not looked at; all others are held apart
/// by boxes of their triangles, grown by half of `reach`. True when that proves nothing, as for a triangle of no area.
bool may_touch_itself(const std::vector<Triangle>& triangles, const Points& x, double reach);

} // namespace toile
