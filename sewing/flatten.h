// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A curved piece laid into the plane with as little strain as may be.

#include "geometry/tri_mesh.h"

namespace toile {

struct FlattenOptions {
    double border_weight = 100;  ///< of a border edge's length over its triangle's strain: sides of a seam keep their lengths
    double tolerance = 1e-9;   ///< change of a place in one round, as a share of the piece's size, at which it is flat
    int max_rounds = 10000;
};

struct Flattened {
    std::vector<Vec2> points; ///< m; fronts counter-clockwise, what was up (y) up on the whole
    int rounds = 0;
    bool settled = false;     ///< whether the tolerance was reached
};

/// `piece` is a disc. Least sum of area |J - R|^2, J the map of a triangle from space and R the rotation nearest to it, by
/// turns in places and rotations (Liu and others: A Local/Global Approach to Mesh Parameterization, 2008), from the least
/// squares conformal map (Levy and others, 2002); alike in all directions. Border edges pull to their lengths besides.
/// Throws std::invalid_argument when the piece has no border of one loop.
Flattened flatten(const TriMesh& piece, const FlattenOptions& options = {});

/// The border of a piece, from its lowest point on as the triangles there run. Throws std::invalid_argument when it is not one loop.
std::vector<int> border_loop(const TriMesh& piece);

/// Principal strains of the cloth when a flat triangle is laid on the surface again, the larger first.
Vec2 laid_strain(const TriMesh& piece, const std::vector<Vec2>& flat, int t);

} // namespace toile
