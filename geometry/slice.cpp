// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/slice.h"

#include <algorithm>
#include <tuple>

namespace toile {

namespace {

using EdgeKey = std::array<int, 2>; ///< a mesh edge, smaller index first

/// A triangle's cut from one of its edges to another, directed so that the solid lies on one side throughout.
struct Cut {
    EdgeKey from, to;
};

EdgeKey key(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

std::vector<Cut> cuts_at(const TriMesh& mesh, double y) {
    std::vector<Cut> cuts;
    for (const Triangle& t : mesh.triangles) {
        const bool above[3] = {mesh.points[t[0]].y() >= y, mesh.points[t[1]].y() >= y, mesh.points[t[2]].y() >= y};
        if (above[0] == above[1] && above[1] == above[2]) continue;
        // Corner k is alone on its side; the cut runs between the two edges at k.
        const int k = above[1] == above[2] ? 0 : above[0] == above[2] ? 1 : 2;
        const EdgeKey next = key(t[k], t[(k + 1) % 3]), last = key(t[k], t[(k + 2) % 3]);
        cuts.push_back(above[k] ? Cut{next, last} : Cut{last, next});
    }
    std::sort(cuts.begin(), cuts.end(),
              [](const Cut& a, const Cut& b) { return std::tie(a.from, a.to) < std::tie(b.from, b.to); });
    return cuts;
}

Vec2 crossing(const TriMesh& mesh, const EdgeKey& e, double y) {
    const Vec3 &a = mesh.points[e[0]], &b = mesh.points[e[1]];
    const double t = (y - a.y()) / (b.y() - a.y());
    return {a.x() + t * (b.x() - a.x()), a.z() + t * (b.z() - a.z())};
}

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

} // namespace

std::vector<std::vector<Vec2>> slice(const TriMesh& mesh, double y) {
    const std::vector<Cut> cuts = cuts_at(mesh, y);
    std::vector<bool> used(cuts.size(), false);
    const auto leaving = [&](const EdgeKey& e) {
        auto it = std::lower_bound(cuts.begin(), cuts.end(), e, [](const Cut& c, const EdgeKey& k) { return c.from < k; });
        while (it != cuts.end() && it->from == e && used[it - cuts.begin()]) ++it;
        return it != cuts.end() && it->from == e ? int(it - cuts.begin()) : -1;
    };
    std::vector<std::vector<Vec2>> loops;
    for (size_t seed = 0; seed < cuts.size(); ++seed) {
        if (used[seed]) continue;
        std::vector<Vec2> loop;
        for (int c = int(seed); c >= 0; c = leaving(cuts[c].to)) {
            used[c] = true;
            loop.push_back(crossing(mesh, cuts[c].from, y));
        }
        loops.push_back(std::move(loop));
    }
    return loops;
}

std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
    std::sort(points.begin(), points.end(),
              [](const Vec2& a, const Vec2& b) { return std::tie(a.x(), a.y()) < std::tie(b.x(), b.y()); });
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return points;
    // Lower chain from left to right, upper chain back (Andrew 1979).
    std::vector<Vec2> hull;
    const auto add = [&](const Vec2& p, size_t keep) {
        while (hull.size() > keep && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0) hull.pop_back();
        hull.push_back(p);
    };
    for (const Vec2& p : points) add(p, 1);
    const size_t lower = hull.size();
    for (size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
    hull.pop_back();
    return hull;
}

double hull_length(const std::vector<Vec2>& points) {
    const std::vector<Vec2> hull = convex_hull(points);
    double length = 0;
    for (size_t i = 0; i < hull.size(); ++i) length += (hull[(i + 1) % hull.size()] - hull[i]).norm();
    return length;
}

LoopArea loop_area(const std::vector<Vec2>& loop) {
    LoopArea result;
    if (loop.empty()) return result;
    double doubled = 0;
    Vec2 moment = Vec2::Zero();
    for (size_t i = 0; i < loop.size(); ++i) {
        const Vec2 a = loop[i] - loop[0], b = loop[(i + 1) % loop.size()] - loop[0];
        doubled += cross(a, b);
        moment += cross(a, b) * (a + b);
    }
    result.area = std::abs(doubled) / 2;
    result.centroid = doubled == 0 ? loop[0] : Vec2(loop[0] + moment / (3 * doubled));
    return result;
}

} // namespace toile
