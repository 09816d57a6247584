// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/garment.h"

#include "geometry/disjoint_sets.h"
#include "patterns/shrink.h"
#include "sewing/mesh_grain.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

namespace toile {
namespace {

constexpr double eased = 0.02; // a seam whose sides differ by more is eased or gathered

/// The edges of rest meshes are chords here; moulded() makes arcs of them.
RestShape rest_of(const Pattern& pattern, const Garment& g) {
    RestShape rest;
    int first = 0; // triangle of the panel
    for (int k = 0; k < int(g.triangles.size()); ++k) {
        const Triangle& t = g.triangles[k];
        if (g.panel_of_triangle[k] != g.panel_of_triangle[first]) first = k;
        if (const auto& own = pattern.panels[g.panel_of_triangle[k]].rest) {
            const Triangle& n = own->mesh.triangles[k - first];
            const Points& x = own->mesh.points;
            rest.edges.push_back(edges_in_grain(x[n[1]] - x[n[0]], x[n[2]] - x[n[0]], own->warp[k - first]));
            continue;
        }
        Mat2 e;
        e << g.uv[t[1]] - g.uv[t[0]], g.uv[t[2]] - g.uv[t[0]];
        rest.edges.push_back(e);
    }
    rest.angles.assign(g.edges.size(), 0.0);
    return rest;
}

void fold_lines(const Pattern& pattern, const FlatLevel& flat, Garment& g) {
    for (std::size_t p = 0; p < flat.lines.size(); ++p)
        for (std::size_t l = 0; l < flat.lines[p].size(); ++l) {
            const std::vector<int>& line = flat.lines[p][l];
            for (std::size_t k = 0; k + 1 < line.size(); ++k) {
                const int e = edge_between(g.edges, line[k], line[k + 1]);
                if (e >= 0) g.rest.angles[e] = pattern.panels[p].lines[l].rest_angle;
            }
        }
}

/// Half of every sewn segment goes to the stitch at each of its ends.
std::vector<Stitch> stitches_of(const FlatLevel& flat, const Garment& g, int seam) {
    std::vector<Stitch> out;
    std::map<std::array<int, 2>, int> number;
    for (const auto& [a, b] : flat.stitches[seam]) {
        if (!number.emplace(std::array{a, b}, int(out.size())).second) continue;
        out.push_back({a, {b, b}, 0, seam, 0});
    }
    for (const SewnSegment& s : flat.sewn[seam]) {
        const double half = 0.25 * (cut_length(g, s.a[0], s.a[1]) + cut_length(g, s.b[0], s.b[1]));
        for (int k = 0; k < 2; ++k) {
            const auto at = number.find({s.a[k], s.b[k]});
            if (at != number.end()) out[at->second].length += half;
        }
    }
    return out;
}

void mark_seams(const Pattern& pattern, const FlatLevel& flat, Garment& g) {
    g.seam_edge.assign(g.edges.size(), false);
    std::vector<bool> on_eased(g.uv.size(), false);
    for (std::size_t s = 0; s < flat.sewn.size(); ++s) {
        const bool uneven = seam_lengths_at_rest(pattern, pattern.seams[s]).ease > eased;
        for (const SewnSegment& segment : flat.sewn[s])
            for (const std::array<int, 2>& side : {segment.a, segment.b}) {
                g.seam_edge[edge_between(g.edges, side[0], side[1])] = true;
                if (uneven) on_eased[side[0]] = on_eased[side[1]] = true;
            }
    }
    for (const Triangle& t : g.triangles)
        g.eased_triangle.push_back(on_eased[t[0]] || on_eased[t[1]] || on_eased[t[2]]);
}

/// The new node of every old one, numbered by the smallest vertex of each.
std::vector<int> merge_nodes(const Garment& g, int& count) {
    DisjointSets sets(g.node_count);
    for (const Stitch& s : g.stitches) {
        if (s.r != 0 && s.r != 1) continue;
        sets.join(s.a, s.b[s.r == 1 ? 1 : 0]);
    }
    std::vector<int> number(g.node_count, -1), map(g.node_count);
    count = 0;
    for (int node : g.node_of_vertex) { // vertices ascending
        int& n = number[sets.find(node)];
        if (n < 0) n = count++;
    }
    for (int node = 0; node < g.node_count; ++node)
        map[node] = number[sets.find(node)];
    return map;
}

void refuse_collapse(const Garment& g) {
    for (int t = 0; t < int(g.triangles.size()); ++t) {
        const Triangle n = g.nodes(t);
        if (n[0] != n[1] && n[1] != n[2] && n[2] != n[0]) continue;
        const Vec2 at = (g.uv[g.triangles[t][0]] + g.uv[g.triangles[t][1]] + g.uv[g.triangles[t][2]]) / 3;
        const int p = g.panel_of_triangle[t];
        throw std::runtime_error(
            "closing the seams would collapse triangle " + std::to_string(t) + " of panel '" +
            (p < int(g.panel_names.size()) ? g.panel_names[p] : std::to_string(p)) + "' near (" +
            std::to_string(at.x()) + ", " + std::to_string(at.y()) +
            ") m: two of its corners are sewn to each other; a finer edge length is needed there");
    }
}

} // namespace

double rest_area(const Mat2& edges) { return 0.5 * std::abs(edges.determinant()); }

std::vector<double> rest_areas(const Garment& garment) {
    std::vector<double> areas;
    for (const Mat2& edges : garment.rest.edges) areas.push_back(rest_area(edges));
    return areas;
}

std::vector<double> node_areas(const Garment& garment) {
    return corner_areas(garment.node_count, node_triangles(garment), rest_areas(garment));
}

double cut_length(const Garment& garment, int a, int b) {
    const int e = edge_between(garment.edges, garment.node_of_vertex[a], garment.node_of_vertex[b]);
    for (int k = garment.edges.first[e]; k < garment.edges.first[e + 1]; ++k) {
        const int t = garment.edges.incident[k];
        for (int corner = 0; corner < 3; ++corner) {
            const int p = garment.triangles[t][(corner + 1) % 3], q = garment.triangles[t][(corner + 2) % 3];
            if (std::minmax(p, q) == std::minmax(a, b)) return rest_edge(garment.rest.edges[t], corner).norm();
        }
    }
    throw std::invalid_argument("vertices " + std::to_string(a) + " and " + std::to_string(b) + " share no edge of the cut cloth");
}

std::vector<int> vertices_along(const Garment& garment, const EdgeSpan& span) {
    const double low = std::min(span.t0, span.t1) - 1e-9, high = std::max(span.t0, span.t1) + 1e-9;
    std::vector<int> out;
    for (const BorderLine& line : garment.borders) {
        if (line.panel != span.panel || line.edge != span.edge) continue;
        for (std::size_t k = 0; k < line.vertices.size(); ++k)
            if (line.at[k] > low && line.at[k] < high) out.push_back(line.vertices[k]);
    }
    if (span.t1 < span.t0) std::reverse(out.begin(), out.end());
    return out;
}

Garment sew(const Pattern& pattern, const FlatLevel& flat) {
    Garment g;
    for (std::size_t v = 0; v < flat.points.size(); ++v)
        g.uv.push_back(to_rest(pattern.panels[flat.panel_of_point[v]]) * flat.points[v]);
    g.panel_of_vertex = flat.panel_of_point;
    g.triangles = flat.triangles;
    g.panel_of_triangle = flat.panel_of_triangle;
    for (const Panel& panel : pattern.panels) {
        g.panel_names.push_back(panel.name);
        g.panel_fabrics.push_back(panel.fabric.empty() ? pattern.fabric : panel.fabric);
        g.panel_layers.push_back(panel.layer);
    }
    g.node_count = int(g.uv.size());
    g.node_of_vertex.resize(g.uv.size());
    std::iota(g.node_of_vertex.begin(), g.node_of_vertex.end(), 0);
    g.edges = make_edges(g.triangles, g.node_count);
    g.rest = rest_of(pattern, g);
    fold_lines(pattern, flat, g);
    for (int s = 0; s < int(flat.stitches.size()); ++s) {
        const std::vector<Stitch> stitches = stitches_of(flat, g, s);
        g.stitches.insert(g.stitches.end(), stitches.begin(), stitches.end());
    }
    mark_seams(pattern, flat, g);
    for (int p = 0; p < int(flat.border.size()); ++p)
        for (int e = 0; e < int(flat.border[p].size()); ++e)
            g.borders.push_back(
                {pattern.panels[p].outline[e].label, p, e, flat.border[p][e], flat.border_at[p][e]});
    return g;
}

Garment close_seams(const Garment& garment, std::vector<int>* node_map) {
    Garment g = garment;
    const std::vector<int> map = merge_nodes(garment, g.node_count);
    for (int& node : g.node_of_vertex)
        node = map[node];
    refuse_collapse(g);
    g.edges = make_edges(node_triangles(g), g.node_count);
    g.rest.angles.assign(g.edges.size(), 0.0);
    g.seam_edge.assign(g.edges.size(), false);
    for (int e = 0; e < garment.edges.size(); ++e) {
        const int merged =
            edge_between(g.edges, map[garment.edges.ends[e][0]], map[garment.edges.ends[e][1]]);
        if (garment.rest.angles[e] != 0) g.rest.angles[merged] = garment.rest.angles[e];
        if (garment.seam_edge[e]) g.seam_edge[merged] = true;
    }
    g.stitches.clear();
    for (Stitch s : garment.stitches) {
        if (s.r == 0 || s.r == 1) continue;
        s.a = map[s.a], s.b = {map[s.b[0]], map[s.b[1]]};
        g.stitches.push_back(s);
    }
    if (node_map) *node_map = map;
    return g;
}

} // namespace toile
