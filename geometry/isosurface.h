// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/tri_mesh.h"

#include <Eigen/Geometry>

#include <functional>

namespace toile {

struct IsosurfaceOptions {
    double cell = 0.01; ///< metres; edges come out about this long
    int relaxations = 8; ///< rounds of evening out the triangles along the surface
};

/// The surface where a field is zero, facing toward larger values: a point for every sheet of the surface in a cell of
/// a grid (Gibson: Constrained elastic surface nets, 1998; Nielson: Dual marching cubes, 2004), moved onto the surface
/// and evened out along it, edges turned until the triangles are Delaunay. The field is called from several threads; near its zero it should grow like a distance.
/// Closed when the field is positive on the box's border (which may be moved by up to three cells). Features thinner
/// than two cells may be lost or joined. Throws std::runtime_error when no grid gives a manifold surface.
TriMesh isosurface(const std::function<double(const Vec3&)>& field, const Eigen::AlignedBox3d& box,
                   const IsosurfaceOptions& options);

} // namespace toile
