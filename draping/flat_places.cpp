// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/flat_places.h"

#include "geometry/distance.h"

#include <Eigen/LU>

#include <cmath>
#include <limits>

namespace toile {
namespace {

Vec3 lifted(const Vec2& p) {
    return {p.x(), p.y(), 0};
}

} // namespace

FlatPanel flat_panel(const Garment& g, int panel) {
    FlatPanel flat;
    std::vector<Box> boxes;
    for (int t = 0; t < int(g.triangles.size()); ++t) {
        if (g.panel_of_triangle[t] != panel || std::abs(g.rest.edges[t].determinant()) < 1e-16) continue;
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

Vec2 place_in_triangle(const Garment& g, int t, const Vec2& at) {
    return g.rest.edges[t].inverse() * (at - g.uv[g.triangles[t][0]]);
}

Vec3 shares_in_triangle(const Garment& g, int triangle, const Vec2& at) {
    const Vec2 along = place_in_triangle(g, triangle, at);
    const Vec3 share = Vec3(1 - along.sum(), along.x(), along.y()).cwiseMax(0.0);
    return share / share.sum();
}

} // namespace toile
