// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Which points a closed surface holds, and how deep: for proofs, by CGAL, with no code shared with the solver's
// contact.

#include "geometry/tri_mesh.h"

namespace toile {

/// How often the surface goes round each point: 1 in a closed surface of which the outside is counter-clockwise,
/// 0 outside, more where parts of it overlap, and on the surface itself the number of one of its sides. Counted along
/// a ray by exact predicates; a ray that meets an edge or a corner counts as moved aside by an infinitely small step
/// (Edelsbrunner and Muecke, Simulation of simplicity, 1990). For a surface with holes the number depends on the ray.
/// Coordinates must be finite (std::invalid_argument).
std::vector<int> winding_numbers(const TriMesh& surface, const Points& points);

/// Distance of each point to the surface, m; infinity when it has no triangle. Triangles without area do not count.
std::vector<double> surface_distances(const TriMesh& surface, const Points& points);

} // namespace toile
