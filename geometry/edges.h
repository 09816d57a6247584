// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/types.h"

namespace toile {

/// The edges of a set of triangles, merged: an edge of a closed seam appears once and knows every triangle on
/// it. One triangle: border. Two: inner edge or seam. Three and more: a waistband or a lining joins there.
struct EdgeTable {
    std::vector<std::array<int, 2>> ends;        ///< smaller index first; sorted
    std::vector<int> first;                      ///< edge e has triangles incident[first[e] .. first[e + 1])
    std::vector<int> incident;                   ///< triangles, ascending within an edge
    std::vector<std::array<int, 3>> of_triangle; ///< edge k of a triangle is opposite its corner k

    int size() const { return int(ends.size()); }
    int triangles_at(int e) const { return first[e + 1] - first[e]; }
};

/// Edge table of `triangles` over indices below `point_count`. Order depends on the indices alone.
/// Throws std::invalid_argument when an index is out of range or a triangle names a point twice.
EdgeTable make_edges(const std::vector<Triangle>& triangles, int point_count);

/// The edge between two points, in either order; -1: there is none.
int edge_between(const EdgeTable& edges, int a, int b);

/// Mean length of the edges, m; 0 without edges.
double mean_length(const EdgeTable& edges, const Points& points);

/// Number of connected pieces of the surface (two triangles are connected when they share a point).
int count_pieces(const std::vector<Triangle>& triangles, int point_count);

/// For every point the lowest index of a point in its piece; points of no triangle are pieces of their own.
std::vector<int> pieces(const std::vector<Triangle>& triangles, int point_count);

} // namespace toile
