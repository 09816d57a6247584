// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Curved pieces laid into the plane with as little strain as may be, so that what is sewn together is of one length.

#include "geometry/tri_mesh.h"

namespace toile {

/// Edges of two pieces, or of one, that are sewn to each other.
struct SewnEdges {
    std::array<int, 2> piece;
    std::array<std::array<int, 2>, 2> points; ///< of each
};

struct FlattenOptions {
    double seam_weight = 1000; ///< of squared differences of sewn edges' lengths over the triangles' strains
    double tolerance = 1e-8;   ///< move of a point in one round, as a share of the pieces' size, at which they are flat
    int max_rounds = 1000;
};

struct Flattened {
    std::vector<Vec2> points; ///< m; fronts counter-clockwise, what was up (y) up on the whole
    int rounds = 0;
    bool settled = false;     ///< whether the tolerance was reached
};

/// Least sum of area times flat_energy (flat_energy.h) of the maps of triangles from space, and of `seam_weight` times sewn_energy, by Newton's
/// method with the positive part of each Hessian, from a map onto a disc (Tutte: How to Draw a Graph, 1963; Floater: Mean Value Coordinates, 2003): no triangle is ever turned
/// over. Alike in all directions. Every piece stands up to expect_disc.
std::vector<Flattened> flatten(const std::vector<TriMesh>& pieces, const std::vector<SewnEdges>& sewn, const FlattenOptions& options = {});

/// Throws std::invalid_argument, which says what is wrong, for a piece that has not one border or has a handle, or a triangle without area.
void expect_disc(const TriMesh& piece);

/// The border of a piece, from its lowest point on as the triangles there run. Throws std::invalid_argument when it is not one loop.
std::vector<int> border_loop(const TriMesh& piece);

/// Principal strains of the cloth when a flat triangle is laid on the surface again, the larger first.
Vec2 laid_strain(const TriMesh& piece, const std::vector<Vec2>& flat, int t);

} // namespace toile
