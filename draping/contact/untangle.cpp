// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/untangle.h"

#include "geometry/bvh.h"
#include "geometry/parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <set>

namespace toile {

namespace {

constexpr double straight = 0.2; // length of the summed directions below which a contour counts as straight

Vec3 normal_of(const Points& x, const Triangle& t) { return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]); }

/// Sum over the triangles at the edge of the unit directions in which the crossing goes on from the edge into each.
Vec3 contour_direction(const TangledCloth& cloth, const Points& x, const ClothCrossing& c, const Vec3& normal) {
    const auto& ends = cloth.edges.ends[c.edge];
    const Vec3 edge = (x[ends[1]] - x[ends[0]]).normalized();
    Vec3 sum = Vec3::Zero();
    for (int k = cloth.edges.first[c.edge]; k < cloth.edges.first[c.edge + 1]; ++k) {
        const Triangle& t = cloth.triangles[cloth.edges.incident[k]];
        const int opposite = *std::find_if(t.begin(), t.end(), [&](int i) { return i != ends[0] && i != ends[1]; });
        const Vec3 along = normal.cross(normal_of(x, t));
        if (!(along.squaredNorm() > 0)) continue;
        const Vec3 arm = x[opposite] - x[ends[0]], inward = arm - arm.dot(edge) * edge;
        sum += (along.dot(inward) < 0 ? -1.0 : 1.0) * along.normalized();
    }
    return sum;
}

/// Halfway to the mean of the neighbours: cloth round a crossing comes along, or it would be crumpled.
Points averaged(const TangledCloth& cloth, const Points& v) {
    Points sum(v.size(), Vec3::Zero());
    std::vector<int> count(v.size(), 0);
    for (const auto& [a, b] : cloth.edges.ends) {
        sum[a] += v[b], sum[b] += v[a];
        ++count[a], ++count[b];
    }
    for (std::size_t i = 0; i < v.size(); ++i) sum[i] = count[i] > 0 ? Vec3((v[i] + sum[i] / count[i]) / 2) : v[i];
    return sum;
}

} // namespace

std::vector<ClothCrossing> find_crossings(const TangledCloth& cloth, const Points& x) {
    const Bvh tree(triangle_boxes(x, cloth.triangles, 0));
    std::set<std::array<int, 2>> sewn;
    for (const auto& [node, end0, end1] : cloth.sewn_to_edge)
        for (const int end : {end0, end1}) sewn.insert({std::min(node, end), std::max(node, end)});
    const auto joined = [&](int a, int b) {
        return a == b || (!sewn.empty() && sewn.count({std::min(a, b), std::max(a, b)}) > 0);
    };
    const int edges = cloth.edges.size(), chunk = 128;
    std::vector<std::vector<ClothCrossing>> found(chunk_count(edges, chunk));
    parallel_for(edges, chunk, [&](int begin, int end) {
        for (int e = begin; e < end; ++e) {
            const auto& ends = cloth.edges.ends[e];
            Box box(x[ends[0]]);
            box.extend(x[ends[1]]);
            const std::size_t first = found[begin / chunk].size();
            tree.overlapping(box, [&](int t) {
                const Triangle& k = cloth.triangles[t];
                if (std::any_of(k.begin(), k.end(), [&](int i) { return joined(i, ends[0]) || joined(i, ends[1]); })) return;
                const auto at = segment_through_triangle(x[ends[0]], x[ends[1]], x[k[0]], x[k[1]], x[k[2]]);
                if (at) found[begin / chunk].push_back({e, t, *at});
            });
            std::sort(found[begin / chunk].begin() + first, found[begin / chunk].end(),
                      [](const ClothCrossing& a, const ClothCrossing& b) { return a.triangle < b.triangle; });
        }
    });
    std::vector<ClothCrossing> all;
    for (const auto& f : found) all.insert(all.end(), f.begin(), f.end());
    return all;
}

Untangled untangle(const TangledCloth& cloth, Points& x, const UntangleOptions& options) {
    Untangled result;
    for (;; ++result.rounds) {
        const std::vector<ClothCrossing> crossings = find_crossings(cloth, x);
        result.after = int(crossings.size());
        if (result.rounds == 0) result.before = result.after;
        if (crossings.empty() || result.rounds == options.max_rounds) return result;
        Points step(x.size(), Vec3::Zero());
        std::vector<double> weight(x.size(), 0.0);
        for (const ClothCrossing& c : crossings) {
            const auto& ends = cloth.edges.ends[c.edge];
            const Triangle& t = cloth.triangles[c.triangle];
            const Vec3 normal = normal_of(x, t).normalized(), edge = (x[ends[1]] - x[ends[0]]).normalized();
            const Vec3 r = contour_direction(cloth, x, c, normal);
            Vec3 g = r - 2 * edge.dot(r) / edge.dot(normal) * normal;
            if (!(g.norm() > 0) || !g.allFinite()) continue;
            g *= options.longest_step * cloth.edge_length * std::min(1.0, r.norm() / straight) / g.norm();
            const auto add = [&](int node, double share, double sign) {
                step[node] += sign * share * g;
                weight[node] += share;
            };
            add(ends[0], 1 - c.at.along, 0.5);
            add(ends[1], c.at.along, 0.5);
            for (int k = 0; k < 3; ++k) add(t[k], c.at.corner[k], -0.5);
        }
        for (std::size_t i = 0; i < x.size(); ++i)
            if (weight[i] > 0) step[i] /= std::max(weight[i], 0.5);
        for (int k = 0; k < options.spread; ++k) step = averaged(cloth, step);
        for (std::size_t i = 0; i < x.size(); ++i) x[i] += step[i];
    }
}

} // namespace toile
