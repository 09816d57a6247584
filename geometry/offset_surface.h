// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/tri_mesh.h"

namespace toile {

/// The surface at a distance of `offset` metres (more than 0) outside of a closed one, in triangles of about `edge` metres.
/// Sides are told by the normal of the nearest face, edge or corner (Baerentzen, Aanaes: Signed Distance Computation Using the Angle
/// Weighted Pseudonormal, 2005); where the body crosses itself, bubbles may be left inside of it.
TriMesh offset_surface(const TriMesh& body, double offset, double edge);

} // namespace toile
