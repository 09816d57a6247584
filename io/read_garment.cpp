// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_garment.h"

#include "io/garment_glb.h"
#include "io/garment_obj.h"
#include "io/write_file.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace toile {
namespace {

constexpr std::uintmax_t max_bytes = std::uintmax_t(1) << 30;
constexpr double most_units = 10; // metres: no garment is as large as this, nor 100 times as large in centimetres

/// Texture coordinates of the corners become vertices: every (uv, node) pair once, in the order of the uv, so
/// that a file with one node per uv keeps its order. Without uv there is one vertex per node.
void make_vertices(const GarmentParts& parts, bool flat, Garment& g) {
    using Key = std::array<int, 2>;
    const auto key = [&](const GarmentParts::Corner& c) {
        return flat ? Key{c.uv, c.node} : Key{c.node, c.node};
    };
    std::vector<Key> keys;
    for (const auto& face : parts.faces)
        for (const auto& c : face.corners)
            keys.push_back(key(c));
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    g.uv.assign(keys.size(), Vec2::Zero());
    g.panel_of_vertex.assign(keys.size(), -1);
    for (const Key& k : keys)
        g.node_of_vertex.push_back(k[1]);
    for (const auto& face : parts.faces) {
        Triangle t{};
        for (int c = 0; c < 3; ++c) {
            const Key k = key(face.corners[std::size_t(c)]);
            t[std::size_t(c)] = int(std::lower_bound(keys.begin(), keys.end(), k) - keys.begin());
            const auto v = std::size_t(t[std::size_t(c)]);
            if (flat) g.uv[v] = parts.uv[std::size_t(k[0])];
            if (g.panel_of_vertex[v] < 0) g.panel_of_vertex[v] = face.panel;
        }
        g.triangles.push_back(t);
        g.panel_of_triangle.push_back(face.panel);
    }
}

/// Only nodes that a triangle uses, in the file's order.
void take_nodes(const GarmentParts& parts, const std::string& name, ReadGarment& out) {
    std::vector<int> to(parts.nodes.size(), -1);
    for (const int n : out.garment.node_of_vertex)
        to[std::size_t(n)] = 0;
    for (std::size_t n = 0; n < to.size(); ++n) {
        if (to[n] < 0) continue;
        to[n] = int(out.x.size());
        out.x.push_back(parts.nodes[n]);
        out.file_node.push_back(int(n));
    }
    for (int& n : out.garment.node_of_vertex)
        n = to[std::size_t(n)];
    const auto moved = [&](int n) {
        if (n < 0 || n >= int(to.size()) || to[std::size_t(n)] < 0)
            throw InputError(name + ": a stitch names node " + std::to_string(n) + ", which no triangle has");
        return to[std::size_t(n)];
    };
    for (const Stitch& s : parts.stitches) {
        Stitch t = s;
        t.a = moved(s.a);
        t.b = {moved(s.b[0]), moved(s.b[1])};
        out.garment.stitches.push_back(t);
    }
    out.garment.node_count = int(out.x.size());
}

double area_in_space(const Garment& g, const Points& x) {
    double sum = 0;
    for (std::size_t t = 0; t < g.triangles.size(); ++t) {
        const Triangle n = g.nodes(int(t));
        const Vec3& o = x[std::size_t(n[0])];
        sum += (x[std::size_t(n[1])] - o).cross(x[std::size_t(n[2])] - o).norm() / 2;
    }
    return sum;
}

double area_of(const Mat2& edges) {
    return std::abs(edges.determinant()) / 2;
}

double area_of_pattern(const Garment& g) {
    double sum = 0;
    for (const Mat2& e : g.rest.edges)
        sum += area_of(e);
    return sum;
}

void make_rest(Garment& g) {
    g.rest.edges.clear();
    for (const Triangle& t : g.triangles) {
        Mat2 edges;
        edges << g.uv[std::size_t(t[1])] - g.uv[std::size_t(t[0])],
            g.uv[std::size_t(t[2])] - g.uv[std::size_t(t[0])];
        g.rest.edges.push_back(edges);
    }
}

/// From the file's texture coordinates to metres of pattern.
void scale_pattern(const GarmentParts& parts, ReadGarment& out) {
    Garment& g = out.garment;
    double scale = parts.uv_metres.value_or(1);
    make_rest(g);
    const double space = area_in_space(g, out.x), flat = area_of_pattern(g);
    if (!parts.uv_metres && flat > 0 && (space / flat > 2 || space / flat < 0.5)) {
        scale = std::sqrt(space / flat);
        out.notes.push_back("the file does not say the scale of its texture coordinates; taking " +
                            std::to_string(scale) + " m per unit makes its area that of the cloth in space");
    }
    std::vector<Vec2> origin(g.panel_names.size(), Vec2::Zero());
    for (std::size_t p = 0; p < origin.size(); ++p)
        if (const auto it = parts.uv_origin.find(g.panel_names[p]); it != parts.uv_origin.end())
            origin[p] = it->second;
    for (std::size_t v = 0; v < g.uv.size(); ++v)
        g.uv[v] = scale * g.uv[v] + origin[std::size_t(g.panel_of_vertex[v])];
    make_rest(g);
}

/// The corner of triangle t that is node n.
int vertex_at(const Garment& g, int t, int n) {
    for (const int v : g.triangles[std::size_t(t)])
        if (g.node_of_vertex[std::size_t(v)] == n) return v;
    return -1;
}

/// Seams are where triangles meet in space but not in the pattern; eased where the pattern's two sides
/// differ.
void find_seams(Garment& g, bool flat) {
    g.seam_edge.assign(std::size_t(g.edges.size()), false);
    g.eased_triangle.assign(g.triangles.size(), false);
    std::vector<bool> stitched(std::size_t(g.node_count), false);
    for (const Stitch& s : g.stitches)
        for (const int n : {s.a, s.b[0], s.b[1]})
            stitched[std::size_t(n)] = true;
    for (int e = 0; e < g.edges.size(); ++e) {
        const auto [n0, n1] = g.edges.ends[std::size_t(e)];
        const int begin = g.edges.first[std::size_t(e)], end = g.edges.first[std::size_t(e) + 1];
        bool seam = end - begin == 1 && stitched[std::size_t(n0)] && stitched[std::size_t(n1)];
        double shortest = INFINITY, longest = 0;
        const int t0 = g.edges.incident[std::size_t(begin)];
        for (int k = begin; k < end; ++k) {
            const int t = g.edges.incident[std::size_t(k)];
            const int v0 = vertex_at(g, t, n0), v1 = vertex_at(g, t, n1);
            seam = seam || v0 != vertex_at(g, t0, n0) || v1 != vertex_at(g, t0, n1);
            const double length = (g.uv[std::size_t(v0)] - g.uv[std::size_t(v1)]).norm();
            shortest = std::min(shortest, length);
            longest = std::max(longest, length);
        }
        g.seam_edge[std::size_t(e)] = seam;
        if (!flat || !seam || longest <= 1.02 * shortest) continue;
        for (int k = begin; k < end; ++k)
            g.eased_triangle[std::size_t(g.edges.incident[std::size_t(k)])] = true;
    }
}

/// The unit of an OBJ that does not say it.
void tell_unit(GarmentParts& parts) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : parts.nodes)
        box.extend(p);
    const double size = parts.nodes.empty() ? 0 : box.sizes().maxCoeff();
    if (size <= most_units) return;
    const bool cm = size <= 100 * most_units;
    parts.metres_per_unit = cm ? 0.01 : 0.001;
    for (Points* points : {&parts.nodes, &parts.avatar.points})
        for (Vec3& p : *points)
            p *= parts.metres_per_unit;
    parts.notes.push_back(std::string("the file does not say its unit; by its size it is in ") +
                          (cm ? "centimetres" : "millimetres"));
}

} // namespace

int panel_index(GarmentParts& parts, const std::string& panel) {
    if (!parts.panel_names.empty() && parts.panel_names.back() == panel)
        return int(parts.panel_names.size()) - 1;
    const auto it = std::find(parts.panel_names.begin(), parts.panel_names.end(), panel);
    if (it == parts.panel_names.end()) parts.panel_names.push_back(panel);
    return int(std::find(parts.panel_names.begin(), parts.panel_names.end(), panel) -
               parts.panel_names.begin());
}

ReadGarment assemble(GarmentParts parts, const std::string& name) {
    if (parts.faces.empty()) throw InputError(name + " has no triangles of a garment");
    if (parts.uv_metres && !(*parts.uv_metres > 0)) throw InputError(name + ": uv_metres must be positive");
    for (const auto& face : parts.faces) {
        const auto& c = face.corners;
        if (c[0].node == c[1].node || c[1].node == c[2].node || c[2].node == c[0].node)
            throw InputError(name + ": a triangle of " + parts.panel_names[std::size_t(face.panel)] +
                             " uses node " + std::to_string(c[0].node == c[1].node ? c[0].node : c[2].node) +
                             " twice");
    }
    ReadGarment out;
    out.flat = std::all_of(parts.faces.begin(), parts.faces.end(), [](const auto& face) {
        return std::all_of(face.corners.begin(), face.corners.end(), [](const auto& c) { return c.uv >= 0; });
    });
    Garment& g = out.garment;
    g.panel_names = parts.panel_names;
    g.panel_fabrics.resize(g.panel_names.size());
    g.panel_layers.resize(g.panel_names.size());
    make_vertices(parts, out.flat, g);
    take_nodes(parts, name, out);
    if (out.flat)
        scale_pattern(parts, out);
    else
        g.rest.edges.assign(g.triangles.size(), Mat2::Zero());
    g.edges = make_edges(node_triangles(g), g.node_count);
    g.rest.angles.assign(std::size_t(g.edges.size()), 0.0);
    find_seams(g, out.flat);
    out.avatar = std::move(parts.avatar);
    out.metres_per_unit = parts.metres_per_unit;
    out.z_up = parts.z_up;
    out.notes.insert(out.notes.begin(), parts.notes.begin(), parts.notes.end());
    return out;
}

ReadGarment read_garment(const std::string& path) {
    const GarmentFormat format = garment_format(path);
    const std::string bytes = read_file(path, max_bytes);
    if (format == GarmentFormat::glb) return assemble(parse_garment_glb(bytes, path), path);
    GarmentParts parts = parse_garment_obj(bytes, path);
    if (!parts.unit_given) tell_unit(parts);
    return assemble(std::move(parts), path);
}

} // namespace toile
