// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The cloth of any garment mesh as one surface, whatever its format split along seams.

#include "geometry/tri_mesh.h"
#include "sewing/garment.h"

namespace toile {

/// Points of the garment at exactly one place on borders are one point of the surface.
struct OneSurface {
    TriMesh mesh;              ///< points are the garment's nodes; those that another stands for have no triangle
    int joined = 0;            ///< nodes that another stands for
    std::vector<int> node;     ///< by node of the garment: the point that stands for it
    std::vector<int> triangle; ///< by triangle of the mesh: the garment's; those that lost a corner are left out
    std::vector<Stitch> stitches; ///< the garment's, over the points that stand for its nodes
};

OneSurface one_surface(const Garment& garment, const Points& x);

} // namespace toile
