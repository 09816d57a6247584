// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/inspect.h"

#include "geometry/solid.h"

#include <algorithm>

namespace toile {

namespace {

TriMesh mesh_in_space(const Garment& garment, const Points& x) {
    TriMesh mesh;
    mesh.points = x;
    for (int t = 0; t < int(garment.triangles.size()); ++t)
        mesh.triangles.push_back(garment.nodes(t));
    return mesh;
}

double area_of(const Points& p, const Triangle& t) {
    return 0.5 * (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).norm();
}

// The direction in which triangle t runs along the edge from a to b: true for a first.
bool runs_along(const Triangle& t, int a, int b) {
    for (int k = 0; k < 3; ++k)
        if (t[k] == a && t[(k + 1) % 3] == b) return true;
    return false;
}

int turned_edges(const TriMesh& mesh, const EdgeTable& edges) {
    int turned = 0;
    for (int e = 0; e < edges.size(); ++e) {
        if (edges.triangles_at(e) != 2) continue;
        const auto [a, b] = edges.ends[e];
        const int first = edges.first[e];
        turned += runs_along(mesh.triangles[edges.incident[first]], a, b) ==
                  runs_along(mesh.triangles[edges.incident[first + 1]], a, b);
    }
    return turned;
}

void measure_surface(const TriMesh& mesh, Inspection& found) {
    const EdgeTable edges = make_edges(mesh.triangles, int(mesh.points.size()));
    found.pieces = count_pieces(mesh.triangles, int(mesh.points.size()));
    found.border_loops = int(border_loops(mesh).size());
    found.crowded_edges = crowded_edges(mesh);
    found.turned_edges = turned_edges(mesh, edges);
    for (const Triangle& t : mesh.triangles) {
        const double area = area_of(mesh.points, t);
        found.area += area;
        found.flat_triangles += area == 0;
    }
    for (const auto& [a, b] : edges.ends)
        found.mean_edge += (mesh.points[a] - mesh.points[b]).norm();
    if (edges.size() > 0) found.mean_edge /= edges.size();
}

} // namespace

Inspection inspect(const Garment& garment, const Points& x, const TriMesh& body,
                   const PanelFabrics& fabrics) {
    Inspection found;
    found.panels = int(garment.panel_names.size());
    found.vertices = int(garment.uv.size());
    found.nodes = garment.node_count;
    found.triangles = int(garment.triangles.size());
    found.not_finite = int(std::count_if(x.begin(), x.end(), [](const Vec3& p) { return !p.allFinite(); }));
    if (found.not_finite > 0) return found;

    TriMesh mesh = mesh_in_space(garment, x);
    found.joined_nodes = join_equal_points(mesh);
    measure_surface(mesh, found);
    if (found.joined_nodes == 0) found.pieces = count_pieces(garment);
    found.seam_gap_max = seam_gap_max(garment, x);
    found.intersections = count_intersections(mesh.triangles, mesh.points, body, garment.stitches);
    found.has_body = !body.triangles.empty();
    if (found.has_body) found.clearance = clearance_min(mesh.triangles, mesh.points, body);
    found.has_pattern = std::any_of(garment.rest.edges.begin(), garment.rest.edges.end(),
                                    [](const Mat2& rest) { return rest.determinant() != 0; });
    if (found.has_pattern) found.strain = measure_strain(garment, x, fabrics);
    found.developability = measure_developability(garment, x);
    return found;
}

} // namespace toile
