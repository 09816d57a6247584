// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// How far apart two drapes are.

#include "geometry/tri_mesh.h"

namespace toile {

struct Comparison {
    bool same_triangles = false; ///< compared point by point; otherwise surface to surface, both ways
    double rms = 0, mean = 0;    ///< m, weighted by area; of the two ways the larger
    double max = 0;              ///< m
    Vec3 where = Vec3::Zero();   ///< where the largest distance starts: on the mesh it is measured from
};

/// Distance between two surfaces in metres, as they lie: neither is moved. Meshes of the same triangles are
/// compared by points of the same index, so that sliding within the surface counts; others by the nearest
/// points of the surfaces, from corners and centroids of the triangles of each to the other. Throws
/// std::invalid_argument when a mesh has no triangles or coordinates that are not finite.
Comparison compare(const TriMesh& a, const TriMesh& b);

} // namespace toile
