// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/foot.h"

#include <limits>

namespace toile {

Foot foot_on(const TriMesh& mesh, const Bvh& tree, const Vec3& p) {
    const auto corners = [&](int t) {
        const auto& [a, b, c] = mesh.triangles[t];
        return std::array{p, mesh.points[a], mesh.points[b], mesh.points[c]};
    };
    const auto nearest = [&](int t) {
        const auto x = corners(t);
        return nearest_point_triangle(x[0], x[1], x[2], x[3]);
    };
    double limit = std::numeric_limits<double>::infinity();
    Foot foot;
    foot.triangle = tree.nearest(p, limit, [&](int t) { return nearest(t).squared; });
    if (foot.triangle < 0) return foot;
    foot.nearest = nearest(foot.triangle);
    foot.at = p + gap_point_triangle(foot.nearest, corners(foot.triangle));
    return foot;
}

} // namespace toile
