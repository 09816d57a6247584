// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "geometry/tri_mesh.h"

namespace toile {

/// The point of a surface that is nearest to another.
struct Foot {
    int triangle = -1; ///< -1: the surface has none
    Nearest nearest;   ///< of the point (first weight) and the triangle's corners
    Vec3 at = Vec3::Zero();
};

/// `tree` has a box of each triangle of `mesh` (triangle_boxes). Of triangles equally near the first counts.
Foot foot_on(const TriMesh& mesh, const Bvh& tree, const Vec3& p);

} // namespace toile
