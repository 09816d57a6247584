// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth that crosses itself, taken apart: every crossing contour is shortened until it is gone. Volino and
// Magnenat-Thalmann: Resolving Surface Collisions through Intersection Contour Minimization, 2006. It needs no
// history and no idea of inside and outside, and pulls a contour that ends at a border out over the border.

#include "geometry/distance.h"
#include "geometry/edges.h"

namespace toile {

/// The cloth and how coarse it is.
struct TangledCloth {
    std::vector<Triangle> triangles;        ///< over nodes
    const EdgeTable& edges;                 ///< of these triangles
    double edge_length = 0;                 ///< m, mean
    std::vector<std::array<int, 3>> sewn_to_edge = {}; ///< as in ContactCloth: what is sewn on touches there
};

/// An edge that passes through a triangle with which it shares no node.
struct ClothCrossing {
    int edge = 0, triangle = 0;
    Passage at;
};

/// Sorted by edge and triangle. In plain floating point: a look by exact predicates has the last word.
std::vector<ClothCrossing> find_crossings(const TangledCloth& cloth, const Points& x);

struct Untangled {
    int before = 0, after = 0; ///< crossings of edges and triangles
    int rounds = 0;
};

/// How far the cloth round a crossing is taken along.
struct UntangleOptions {
    double longest_step = 0.4; ///< of the edge length, in one round
    int spread = 8;            ///< rounds of averaging with the neighbours
    int max_rounds = 400;
};

/// Moves the nodes of `x` near crossings until there are none, or `max_rounds` are over.
Untangled untangle(const TangledCloth& cloth, Points& x, const UntangleOptions& options = {});

} // namespace toile
