// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/start_from.h"

#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "io/garment_obj.h"

#include <Eigen/LU>

#include <algorithm>

namespace toile {
namespace {

Vec3 lifted(const Vec2& p) {
    return {p.x(), p.y(), 0};
}

/// A panel of the earlier drape, flat, to be looked up in.
struct FlatPanel {
    std::vector<int> triangles; ///< of the earlier garment
    Bvh tree;
};

FlatPanel make_panel(const Garment& g, int panel) {
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

/// The triangle's plane, also beyond its corners.
Vec3 place_in(const ReadGarment& earlier, int t, const Vec2& at) {
    const Garment& g = earlier.garment;
    const Vec2 weight = g.rest.edges[t].inverse() * (at - g.uv[g.triangles[t][0]]);
    const Triangle n = g.nodes(t);
    const Vec3& o = earlier.x[n[0]];
    return o + weight.x() * (earlier.x[n[1]] - o) + weight.y() * (earlier.x[n[2]] - o);
}

} // namespace

Points start_from(const ReadGarment& earlier, const Garment& garment, const std::string& name) {
    if (!earlier.flat)
        throw InputError(name + " has no texture coordinates, by which its cloth could be recognised");
    std::vector<FlatPanel> panels;
    const std::vector<std::string> names = group_names(garment);
    for (std::size_t p = 0; p < names.size(); ++p) {
        const auto& known = earlier.garment.panel_names; // GLB keeps the name, OBJ what fits
        const auto it = std::find_if(known.begin(), known.end(), [&](const std::string& k) {
            return k == names[p] || k == garment.panel_names[p];
        });
        panels.push_back(it == known.end() ? FlatPanel{}
                                           : make_panel(earlier.garment, int(it - known.begin())));
        if (panels.back().triangles.empty())
            throw InputError(name + " has no panel '" + garment.panel_names[p] + "' to start from");
    }
    Points x(garment.node_count, Vec3::Zero());
    std::vector<int> count(garment.node_count, 0);
    for (std::size_t v = 0; v < garment.uv.size(); ++v) {
        const int t = nearest_triangle(earlier.garment, panels[garment.panel_of_vertex[v]], garment.uv[v]);
        x[garment.node_of_vertex[v]] += place_in(earlier, t, garment.uv[v]);
        ++count[garment.node_of_vertex[v]];
    }
    for (int n = 0; n < garment.node_count; ++n)
        x[n] /= count[n];
    return x;
}

} // namespace toile
