// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The garment as one cloth: cut vertices that know their panel, nodes in space that seams share.

#include "geometry/edges.h"
#include "geometry/tri_mesh.h"
#include "patterns/triangulate.h"

namespace toile {

/// What the cloth wants to be: per triangle its two edge vectors along the cloth, per edge the angle it wants to be
/// bent by, per triangle how it wants to be curved. Not a rest position per vertex: a moulded cup or an eased seam
/// has none.
struct RestShape {
    std::vector<Mat2> edges; ///< columns: corner 1 - corner 0, corner 2 - corner 0; rows: weft, warp; metres
    std::vector<double> angles; ///< rad, one per entry of Garment::edges; 0 is flat
    /// Empty for flat cloth, otherwise one per triangle, 1/m. Rows: second derivatives (uu, vv, uv) of the surface over
    /// (weft, warp); columns: their components along the triangle's weft, warp and normal. The last column is the second
    /// fundamental form, positive where the cloth curves toward its right side. The others are Christoffel symbols, 0 for
    /// who knows the curvature alone; moulded() in draping/rest has them, with which rest is exactly at rest.
    std::vector<Mat3> curvature;
};

/// Area of a triangle with these rest edges, m2.
double rest_area(const Mat2& edges);
/// Its edge opposite corner k, up to its sense: (weft, warp).
inline Vec2 rest_edge(const Mat2& edges, int k) {
    return k == 0 ? Vec2(edges.col(1) - edges.col(0)) : Vec2(edges.col(k == 1 ? 1 : 0));
}

/// A zero-rest-length spring from node a to the point (1 - r) b[0] + r b[1].
struct Stitch {
    int a = 0;
    std::array<int, 2> b{};
    double r = 0;
    int seam = 0;
    double length = 0; ///< metres of seam that the stitch stands for
};

/// The point of the edge b that a stitch joins its node to, and how far the node still is from it.
inline Vec3 seam_point(const Stitch& s, const Points& x) { return (1 - s.r) * x[s.b[0]] + s.r * x[s.b[1]]; }
inline double stitch_gap(const Stitch& s, const Points& x) {
    return (x[s.a] - (1 - s.r) * x[s.b[0]] - s.r * x[s.b[1]]).norm();
}

/// Nodes along a stretch of cut border, kept by name: what hooks, pins, elastics and landmarks refer to.
struct BorderLine {
    std::string label;
    int panel = 0, edge = 0;
    std::vector<int> vertices; ///< in order along the edge
    std::vector<double> at;    ///< where they lie, as fractions of the edge's length
};

struct Garment {
    // The cut cloth, by vertex and triangle.
    std::vector<Vec2> uv; ///< grain coordinates (weft, warp) in metres, of the cloth at rest unless that is moulded
    std::vector<int> panel_of_vertex;
    std::vector<Triangle> triangles; ///< over vertices; front is the fabric's right side
    std::vector<int> panel_of_triangle;
    std::vector<std::string> panel_names;
    std::vector<std::string> panel_fabrics; ///< empty: the garment's
    std::vector<int> panel_layers;
    RestShape rest;

    // The cloth in space, by node.
    std::vector<int> node_of_vertex;
    int node_count = 0;
    EdgeTable edges;                  ///< over nodes
    std::vector<Stitch> stitches;     ///< open seams, over nodes
    std::vector<bool> seam_edge;      ///< per edge: lies on a seam (closed or open) or dart
    std::vector<bool> eased_triangle; ///< per triangle: touches a seam whose sides differ by more than 2 %
    std::vector<BorderLine> borders;  ///< every outline edge of every panel

    /// Triangle t over nodes.
    Triangle nodes(int t) const {
        const Triangle& v = triangles[t];
        return {node_of_vertex[v[0]], node_of_vertex[v[1]], node_of_vertex[v[2]]};
    }
};

/// Whether the cloth is folded at this edge: it is smooth elsewhere.
inline bool is_crease(const Garment& garment, int edge) { return garment.rest.angles[edge] != 0; }

/// The rest area of every triangle, m2, and of every node: a third of those of the triangles round it.
std::vector<double> rest_areas(const Garment& garment);
std::vector<double> node_areas(const Garment& garment);

/// Vertices of the garment along a span of an outline, from t0 to t1. Spans of seams, pins and elastics end
/// exactly in vertices; of others, the vertices inside are returned.
std::vector<int> vertices_along(const Garment& garment, const EdgeSpan& span);

/// The length of the edge between two vertices of one panel by the rest shape, m. Throws std::invalid_argument when there is none.
double cut_length(const Garment& garment, int a, int b);

/// The garment of one level, every seam open: one node per vertex, stitches across the seams.
Garment sew(const Pattern& pattern, const FlatLevel& flat);

/// The garment with its stitches closed: stitched nodes become one. Stitches to the inside of an edge
/// (0 < r < 1) stay. `node_map`, when given, receives the new node of every old node.
Garment close_seams(const Garment& garment, std::vector<int>* node_map = nullptr);

/// Triangles over nodes with the given positions.
inline std::vector<Triangle> node_triangles(const Garment& garment) {
    std::vector<Triangle> triangles;
    for (std::size_t t = 0; t < garment.triangles.size(); ++t)
        triangles.push_back(garment.nodes(int(t)));
    return triangles;
}

} // namespace toile
