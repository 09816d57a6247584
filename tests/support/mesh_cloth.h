// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A garment without a pattern over any mesh.

#include "geometry/tri_mesh.h"
#include "sewing/garment.h"

namespace toile::test {

struct Cloth {
    Garment garment;
    Points x;
};

inline Cloth cloth_of(const TriMesh& mesh) {
    Cloth c;
    c.garment.triangles = mesh.triangles;
    c.garment.panel_of_triangle.assign(mesh.triangles.size(), 0);
    c.garment.panel_names = {"cloth"};
    c.garment.rest.edges.assign(mesh.triangles.size(), Mat2::Zero());
    c.garment.uv.assign(mesh.points.size(), Vec2::Zero());
    c.garment.panel_of_vertex.assign(mesh.points.size(), 0);
    c.garment.node_count = int(mesh.points.size());
    for (int i = 0; i < c.garment.node_count; ++i)
        c.garment.node_of_vertex.push_back(i);
    c.garment.edges = make_edges(mesh.triangles, c.garment.node_count);
    c.garment.seam_edge.assign(c.garment.edges.size(), false);
    c.garment.eased_triangle.assign(mesh.triangles.size(), false);
    c.x = mesh.points;
    return c;
}

/// Puts a mesh after what is there.
inline void append(TriMesh& to, const TriMesh& part) {
    const int first = int(to.points.size());
    to.points.insert(to.points.end(), part.points.begin(), part.points.end());
    for (const Triangle& t : part.triangles)
        to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

} // namespace toile::test
