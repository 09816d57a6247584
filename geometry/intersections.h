// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The proof that a drape does not cut itself or its avatar: exact predicates (CGAL), no code shared with the
// solver's contact.

#include "geometry/tri_mesh.h"

namespace toile {

/// Pairs of triangles that intersect, (i of a, j of b), sorted. Touching counts as intersecting. Triangles
/// that are a segment or a point count as such. Coordinates must be finite (std::invalid_argument).
std::vector<std::array<int, 2>> intersecting_pairs(const TriMesh& a, const TriMesh& b);

/// Pairs i < j of triangles of one mesh that intersect other than in the points they share, sorted. Triangles
/// that share one or two indices are tested for what lies beyond them: neighbours folded flat onto each other
/// intersect, and so does a triangle given twice. Points at the same place with different indices are
/// different points: triangles there touch.
std::vector<std::array<int, 2>> self_intersecting_pairs(const TriMesh& mesh);

} // namespace toile
