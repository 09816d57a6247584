// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/carry_drape.h"

#include "geometry/bvh.h"
#include "geometry/distance.h"

#include <Eigen/LU>

#include <cmath>
#include <limits>

namespace toile {
namespace {

Vec3 lifted(const Vec2& p) {
    return {p.x(), p.y(), 0};
}

bool has_place(const Garment& g, int panel, int t) {
    return g.panel_of_triangle[t] == panel && std::abs(g.rest.edges[t].determinant()) >= 1e-16;
}

/// A panel of the earlier drape, flat, to be looked up in.
struct FlatPanel {
    std::vector<int> triangles; ///< of its garment
    Bvh tree;
};

FlatPanel make_panel(const Garment& g, int panel) {
    FlatPanel flat;
    std::vector<Box> boxes;
    for (int t = 0; t < int(g.triangles.size()); ++t) {
        if (!has_place(g, panel, t)) continue;
        flat.triangles.push_back(t);
        boxes.emplace_back();
        for (const int v : g.triangles[t])
            boxes.back().extend(lifted(g.uv[v]));
    }
    flat.tree = Bvh(boxes);
    return flat;
}

int nearest_triangle(const Garment& g, const FlatPanel& flat, const Vec2& at) {
    double limit = std::numeric_limits<double>::infinity();
    const int i = flat.tree.nearest(lifted(at), limit, [&](int item) {
        const Triangle& t = g.triangles[flat.triangles[item]];
        return nearest_point_triangle(lifted(at), lifted(g.uv[t[0]]), lifted(g.uv[t[1]]), lifted(g.uv[t[2]]))
            .squared;
    });
    return flat.triangles[i];
}

/// The triangle's plane, also beyond its corners.
Vec3 place_in(const Garment& g, const Points& x, int t, const Vec2& at) {
    const Vec2 weight = g.rest.edges[t].inverse() * (at - g.uv[g.triangles[t][0]]);
    const Triangle n = g.nodes(t);
    const Vec3& o = x[n[0]];
    return o + weight.x() * (x[n[1]] - o) + weight.y() * (x[n[2]] - o);
}

} // namespace

bool can_carry(const Garment& from, int panel) {
    for (int t = 0; t < int(from.triangles.size()); ++t)
        if (has_place(from, panel, t)) return true;
    return false;
}

Points carry_drape(const Garment& from, const Points& x, const Garment& to, const std::vector<int>& panel_of) {
    std::vector<FlatPanel> panels;
    for (const int p : panel_of) panels.push_back(make_panel(from, p));
    Points out(to.node_count, Vec3::Zero());
    std::vector<int> count(to.node_count, 0);
    for (std::size_t v = 0; v < to.uv.size(); ++v) {
        const int t = nearest_triangle(from, panels[to.panel_of_vertex[v]], to.uv[v]);
        out[to.node_of_vertex[v]] += place_in(from, x, t, to.uv[v]);
        ++count[to.node_of_vertex[v]];
    }
    for (int n = 0; n < to.node_count; ++n)
        out[n] /= count[n];
    return out;
}

} // namespace toile
