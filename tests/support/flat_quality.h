// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What triangulations promise, measured from the mesh alone.

#include "patterns/triangulate.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace toile::test {

struct FlatQuality {
    double mean_ratio = 1;       ///< mean edge / target, away from awkward border points
    double smallest_angle = 180; ///< degrees, of triangles away from awkward border points
    double smallest_of_all = 180;
};

inline double plane_cross(const Vec2& a, const Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}

inline double doubled_area(const FlatLevel& level, int t) {
    const Triangle& v = level.triangles[t];
    return plane_cross(level.points[v[1]] - level.points[v[0]], level.points[v[2]] - level.points[v[0]]);
}

/// Edges of the mesh (smaller index first) and how many triangles have them.
inline std::map<std::array<int, 2>, int> edge_uses(const FlatLevel& level) {
    std::map<std::array<int, 2>, int> uses;
    for (const Triangle& t : level.triangles)
        for (int k = 0; k < 3; ++k) {
            const int a = t[k], b = t[(k + 1) % 3];
            ++uses[{std::min(a, b), std::max(a, b)}];
        }
    return uses;
}

inline double corner_angle(const FlatLevel& level, const Triangle& t, int k) {
    const Vec2 u = level.points[t[(k + 1) % 3]] - level.points[t[k]],
               v = level.points[t[(k + 2) % 3]] - level.points[t[k]];
    return std::abs(std::atan2(plane_cross(u, v), u.dot(v)));
}

/// Points of border corners below 60 degrees and of border samples under half or over twice the target.
inline std::vector<int> awkward_points(const FlatLevel& level,
                                       const std::map<std::array<int, 2>, int>& uses) {
    std::vector<double> angle(level.points.size(), 0);
    for (const Triangle& t : level.triangles)
        for (int k = 0; k < 3; ++k)
            angle[t[k]] += corner_angle(level, t, k);
    std::set<int> out;
    for (const auto& [edge, count] : uses) {
        if (count > 1) continue;
        const double length = (level.points[edge[1]] - level.points[edge[0]]).norm() / level.edge_length;
        for (int p : edge)
            if (length < 0.5 || length > 2 || angle[p] < EIGEN_PI / 3 - 1e-9) out.insert(p);
    }
    return {out.begin(), out.end()};
}

/// `reach` in edge lengths: how far from awkward points nothing is promised.
inline FlatQuality measure(const FlatLevel& level, double reach = 1) {
    const auto uses = edge_uses(level);
    const std::vector<int> awkward = awkward_points(level, uses);
    std::vector<bool> exempt(level.points.size(), false);
    for (std::size_t p = 0; p < exempt.size(); ++p)
        for (int a : awkward)
            exempt[p] =
                exempt[p] || (level.panel_of_point[a] == level.panel_of_point[p] &&
                              (level.points[a] - level.points[p]).norm() <= reach * level.edge_length);
    FlatQuality q;
    double sum = 0;
    int count = 0;
    for (const auto& [edge, n] : uses) {
        if (exempt[edge[0]] || exempt[edge[1]]) continue;
        sum += (level.points[edge[1]] - level.points[edge[0]]).norm() / level.edge_length;
        ++count;
    }
    if (count > 0) q.mean_ratio = sum / count;
    for (const Triangle& t : level.triangles)
        for (int k = 0; k < 3; ++k) {
            const double degrees = corner_angle(level, t, k) * 180 / EIGEN_PI;
            q.smallest_of_all = std::min(q.smallest_of_all, degrees);
            if (!exempt[t[0]] && !exempt[t[1]] && !exempt[t[2]])
                q.smallest_angle = std::min(q.smallest_angle, degrees);
        }
    return q;
}

} // namespace toile::test
