// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The mesh of a panel that is not flat at rest, and the edges of it that can be sewn.

#include "io/input_error.h"
#include "patterns/rest_mesh.h"

namespace toile {

struct RestMeshOptions {
    /// Edges along the border from one point to another by their numbers in the file, from 1; all the way round where the two
    /// are the same.
    std::vector<std::array<int, 2>> edges;
    Vec3 warp = Vec3::Zero(); ///< direction of the warp in the file; 0: along v of its texture coordinates, else along y
};

/// An OBJ or GLB, its unit as read_garment() tells it, y up. Throws InputError naming the file and the element: no mesh,
/// triangles without area, an edge of more than two triangles or of two that run the same way, borders that meet in a point, several
/// pieces, ends of edges that are no points of one border, edges that overlap.
RestMesh read_rest_mesh(const std::string& path, const RestMeshOptions& options = {});

} // namespace toile
