// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/inspect.h"

#include "draping/one_surface.h"
#include "geometry/disjoint_sets.h"
#include "geometry/inside.h"
#include "geometry/solid.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace toile {

namespace {

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
        const double area = triangle_area(mesh.points, t);
        found.area += area;
        found.flat_triangles += area == 0;
    }
    found.mean_edge = mean_length(edges, mesh.points);
}

// ---- crossings

using Box = Eigen::AlignedBox3d;

Box box_of(const TriMesh& mesh, int t) {
    Box box;
    for (const int i : mesh.triangles[t]) box.extend(mesh.points[i]);
    return box;
}

// Pairs that hang together: those that have a corner of the one and a corner of the other triangle in common.
std::vector<int> together(const TriMesh& a, const TriMesh& b, bool same, const std::vector<std::array<int, 2>>& pairs) {
    struct Corners {
        int a, b, pair;
    };
    std::vector<Corners> corners;
    for (int k = 0; k < int(pairs.size()); ++k)
        for (const int i : a.triangles[pairs[k][0]])
            for (const int j : b.triangles[pairs[k][1]])
                corners.push_back(same ? Corners{std::min(i, j), std::max(i, j), k} : Corners{i, j, k});
    std::sort(corners.begin(), corners.end(), [](const Corners& p, const Corners& q) {
        return std::tie(p.a, p.b, p.pair) < std::tie(q.a, q.b, q.pair);
    });
    DisjointSets sets(int(pairs.size()));
    for (std::size_t k = 1; k < corners.size(); ++k)
        if (corners[k].a == corners[k - 1].a && corners[k].b == corners[k - 1].b)
            sets.join(corners[k].pair, corners[k - 1].pair);
    return sets.all();
}

// A place that both triangles of a pair come near: the middle of what their boxes have in common.
Vec3 place_of(const TriMesh& a, const TriMesh& b, const std::array<int, 2>& pair) {
    return box_of(a, pair[0]).intersection(box_of(b, pair[1])).center();
}

Vec3 nearest_to_middle(const Points& places) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : places) middle += p / double(places.size());
    return *std::min_element(places.begin(), places.end(), [&](const Vec3& p, const Vec3& q) {
        return (p - middle).squaredNorm() < (q - middle).squaredNorm();
    });
}

// `pairs` are of the surface's triangles, and come out as those of the garment.
void add_crossings(const Garment& garment, const OneSurface& cloth, const TriMesh* body,
                   const std::vector<std::array<int, 2>>& pairs, std::vector<Crossing>& crossings) {
    const TriMesh& other = body ? *body : cloth.mesh;
    const std::vector<int> set = together(cloth.mesh, other, !body, pairs);
    std::map<int, std::pair<Crossing, Points>> by_set;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        auto& [crossing, places] = by_set[set[k]];
        crossing.with_body = body;
        const int a = cloth.triangle[pairs[k][0]], b = body ? pairs[k][1] : cloth.triangle[pairs[k][1]];
        crossing.pairs.push_back({a, b});
        crossing.panels.push_back(garment.panel_of_triangle[a]);
        if (!body) crossing.panels.push_back(garment.panel_of_triangle[b]);
        places.push_back(place_of(cloth.mesh, other, pairs[k]));
    }
    const std::size_t first = crossings.size();
    for (auto& [number, found] : by_set) {
        auto& [crossing, places] = found;
        crossing.at = nearest_to_middle(places);
        std::sort(crossing.panels.begin(), crossing.panels.end());
        crossing.panels.erase(std::unique(crossing.panels.begin(), crossing.panels.end()), crossing.panels.end());
        crossings.push_back(std::move(crossing));
    }
    std::stable_sort(crossings.begin() + first, crossings.end(),
                     [](const Crossing& a, const Crossing& b) { return a.pairs.size() > b.pairs.size(); });
}

// ---- inside

InsideBody find_inside(const Garment& garment, const OneSurface& cloth, const TriMesh& body) {
    InsideBody inside;
    TriMesh closed = body;
    join_equal_points(closed);
    inside.known = !closed.triangles.empty() && border_loops(closed).empty();
    if (!inside.known) return inside;
    std::vector<int> panel(cloth.mesh.points.size(), -1);
    for (int t = int(garment.triangles.size()) - 1; t >= 0; --t)
        for (const int n : garment.nodes(t)) panel[cloth.node[n]] = garment.panel_of_triangle[t];
    std::vector<int> nodes;
    Points points;
    for (int n = 0; n < int(panel.size()); ++n)
        if (panel[n] >= 0) {
            nodes.push_back(n);
            points.push_back(cloth.mesh.points[n]);
        }
    const std::vector<int> winding = winding_numbers(closed, points);
    std::vector<int> held;
    Points held_points;
    for (std::size_t k = 0; k < nodes.size(); ++k)
        if (winding[k] != 0) { // a body turned inside out holds what it holds
            held.push_back(nodes[k]);
            held_points.push_back(points[k]);
        }
    const std::vector<double> depth = surface_distances(closed, held_points);
    for (std::size_t k = 0; k < held.size(); ++k) {
        if (!(depth[k] > 0)) continue; // on the surface
        ++inside.nodes;
        if (depth[k] <= inside.depth) continue;
        inside.depth = depth[k];
        inside.at = held_points[k];
        inside.panel = panel[held[k]];
    }
    return inside;
}

// ---- seams

bool has_edge(const EdgeTable& edges, int a, int b) {
    const std::array<int, 2> ends{std::min(a, b), std::max(a, b)};
    return a == b || std::binary_search(edges.ends.begin(), edges.ends.end(), ends);
}

int panel_of_node(const Garment& garment, int node) {
    const auto at = std::find(garment.node_of_vertex.begin(), garment.node_of_vertex.end(), node);
    return at == garment.node_of_vertex.end() ? -1 : garment.panel_of_vertex[at - garment.node_of_vertex.begin()];
}

// Stitches next to each other on both sides of the seam are one run.
std::vector<SeamGap> find_gaps(const Garment& garment, const Points& x) {
    const std::vector<Stitch>& stitches = garment.stitches;
    std::multimap<int, int> of_node; // stitches by their first node
    for (int k = 0; k < int(stitches.size()); ++k) of_node.emplace(stitches[k].a, k);
    DisjointSets runs(int(stitches.size()));
    const auto join_at = [&](int node, int k) {
        const auto [begin, end] = of_node.equal_range(node);
        for (auto it = begin; it != end; ++it)
            for (const int p : stitches[k].b)
                for (const int q : stitches[it->second].b)
                    if (has_edge(garment.edges, p, q)) runs.join(k, it->second);
    };
    std::vector<std::vector<int>> next(stitches.empty() ? 0 : garment.node_count);
    if (!stitches.empty())
        for (const auto& [a, b] : garment.edges.ends) {
            next[a].push_back(b);
            next[b].push_back(a);
        }
    for (int k = 0; k < int(stitches.size()); ++k) {
        join_at(stitches[k].a, k);
        for (const int node : next[stitches[k].a]) join_at(node, k);
    }
    std::map<int, SeamGap> by_run;
    for (int k = 0; k < int(stitches.size()); ++k) {
        SeamGap& seam = by_run[runs.find(k)];
        const double gap = stitch_gap(stitches[k], x);
        ++seam.stitches;
        seam.open += gap > 0;
        if (gap <= seam.gap) continue;
        seam.gap = gap;
        seam.at = 0.5 * (x[stitches[k].a] + seam_point(stitches[k], x));
        seam.panels = {panel_of_node(garment, stitches[k].a), panel_of_node(garment, stitches[k].b[0])};
    }
    std::vector<SeamGap> gaps;
    for (const auto& [run, seam] : by_run)
        if (seam.gap > 0) gaps.push_back(seam);
    std::stable_sort(gaps.begin(), gaps.end(), [](const SeamGap& a, const SeamGap& b) { return a.gap > b.gap; });
    return gaps;
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

    const OneSurface cloth = one_surface(garment, x);
    const TriMesh& mesh = cloth.mesh;
    found.joined_nodes = cloth.joined;
    measure_surface(mesh, found);
    if (found.joined_nodes == 0) found.pieces = count_pieces(garment);
    found.seam_gap_max = seam_gap_max(garment, x);
    found.gaps = find_gaps(garment, x);
    const IntersectingPairs pairs = find_intersections(mesh.triangles, mesh.points, body, cloth.stitches);
    found.intersections = {int(pairs.cloth_avatar.size()), int(pairs.cloth_cloth.size())};
    add_crossings(garment, cloth, &body, pairs.cloth_avatar, found.crossings);
    add_crossings(garment, cloth, nullptr, pairs.cloth_cloth, found.crossings);
    found.has_body = !body.triangles.empty();
    if (found.has_body) {
        found.clearance = clearance_min(mesh.triangles, mesh.points, body);
        found.inside = find_inside(garment, cloth, body);
    }
    found.has_pattern = std::any_of(garment.rest.edges.begin(), garment.rest.edges.end(),
                                    [](const Mat2& rest) { return rest.determinant() != 0; });
    if (found.has_pattern) found.strain = measure_strain(garment, x, fabrics);
    found.developability = measure_developability(garment, x);
    return found;
}

} // namespace toile
