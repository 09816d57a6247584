// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What makes a heap of triangles the surface of a solid: shared corners, one orientation, no holes.

#include "geometry/tri_mesh.h"

namespace toile {

/// Joins points that lie in one place and are on an open border, or are the two ends of an edge without length:
/// formats that store every corner apart (STL) or split them for shading (GLB) become one surface again. Points
/// of two closed parts that merely touch stay two. The first of equal points stays. Drops the triangles that
/// lose a corner. Returns the number of points joined (they stay in the mesh, without triangles).
int join_equal_points(TriMesh& mesh);

/// Drops points that no triangle names; the order of the others is kept. Returns their number.
int drop_unused_points(TriMesh& mesh);

/// Drops triangles of no area; where one bridges its neighbours (its corners on one line) the neighbours are
/// joined by turning the longest edge. Returns the number of triangles dropped or turned.
int drop_flat_triangles(TriMesh& mesh);

/// Turns triangles so that neighbours agree, and whole pieces so that their volume is positive. Returns the
/// number of triangles turned.
int orient_outward(TriMesh& mesh);

double volume(const TriMesh& mesh); ///< signed, m3

/// Unit normals of the points, weighted by the areas of their triangles. No number where a point has no area round it.
Points vertex_normals(const TriMesh& mesh);

/// The open border as loops of points, each directed so that a triangle (a, b, x) closes edge a -> b. Empty for
/// a closed surface. Edges of more than two triangles are closed when as many run one way as the other.
std::vector<std::vector<int>> border_loops(const TriMesh& mesh);

/// Edges that carry more than two triangles.
int crowded_edges(const TriMesh& mesh);

/// Triangles that fill a loop of points with the least area (Barequet, Sharir: Filling gaps in the boundary of a
/// polyhedron, 1995). Takes time n^3: at most 500 points.
std::vector<Triangle> fill_loop(const Points& points, const std::vector<int>& loop);

} // namespace toile
