// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/self_touch.h"

#include "geometry/bvh.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace toile {

namespace {

constexpr double patch_cone = 25 * EIGEN_PI / 180; // half angles, of a patch
constexpr double pair_cone = 75 * EIGEN_PI / 180;  // and of two that are next to each other

struct Patches {
    std::vector<int> of_triangle;
    std::vector<Vec3> axis; ///< normal of each patch's first triangle
};

std::vector<std::vector<int>> triangles_of_nodes(const std::vector<Triangle>& triangles, std::size_t nodes) {
    std::vector<std::vector<int>> of_node(nodes);
    for (int t = 0; t < int(triangles.size()); ++t)
        for (const int i : triangles[t]) of_node[i].push_back(t);
    return of_node;
}

/// Connected by nodes.
Patches grow_patches(const std::vector<Triangle>& triangles, const std::vector<Vec3>& normal, const std::vector<std::vector<int>>& of_node) {
    Patches p{std::vector<int>(triangles.size(), -1), {}};
    std::vector<int> front;
    for (int first = 0; first < int(triangles.size()); ++first) {
        if (p.of_triangle[first] >= 0) continue;
        const int patch = int(p.axis.size());
        p.axis.push_back(normal[first]);
        p.of_triangle[first] = patch;
        front.assign(1, first);
        while (!front.empty()) {
            const int t = front.back();
            front.pop_back();
            for (const int i : triangles[t])
                for (const int u : of_node[i]) {
                    if (p.of_triangle[u] >= 0 || normal[u].dot(p.axis[patch]) < std::cos(patch_cone)) continue;
                    p.of_triangle[u] = patch;
                    front.push_back(u);
                }
        }
    }
    return p;
}

} // namespace

bool may_touch_itself(const std::vector<Triangle>& triangles, const Points& x, double reach) {
    std::vector<Vec3> normal;
    for (const Triangle& t : triangles) {
        const Vec3 n = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
        if (!(n.norm() > 0)) return true;
        normal.push_back(n.normalized());
    }
    const std::vector<std::vector<int>> of_node = triangles_of_nodes(triangles, x.size());
    const Patches patches = grow_patches(triangles, normal, of_node);
    std::set<std::pair<int, int>> next; // patches that share a node
    for (const std::vector<int>& around : of_node)
        for (const int t : around)
            for (const int u : around)
                if (patches.of_triangle[t] < patches.of_triangle[u]) next.insert({patches.of_triangle[t], patches.of_triangle[u]});
    for (const auto& [a, b] : next)
        if (patches.axis[a].dot(patches.axis[b]) < std::cos(2 * (pair_cone - patch_cone))) return true;
    bool meet = false;
    Bvh(triangle_boxes(x, triangles, reach / 2)).overlapping_pairs([&](int t, int u) {
        const auto [a, b] = std::minmax(patches.of_triangle[t], patches.of_triangle[u]);
        meet = meet || (a != b && !next.count({a, b}));
    });
    return meet;
}

} // namespace toile
