// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/offset_surface.h"

#include "geometry/bvh_impl.h"
#include "geometry/distance.h"
#include "geometry/edges.h"
#include "geometry/isosurface.h"

#include <cmath>

namespace toile {

namespace {

/// Distance to a body, negative inside.
class SignedDistance {
public:
    explicit SignedDistance(const TriMesh& body)
        : body_(body), tree_(triangle_boxes(body.points, body.triangles, 0)), edges_(make_edges(body.triangles, int(body.points.size()))),
          at_edge_(edges_.size(), Vec3::Zero()), at_point_(body.points.size(), Vec3::Zero()) {
        for (std::size_t t = 0; t < body.triangles.size(); ++t) {
            const Triangle& n = body.triangles[t];
            const auto side = [&](int k) { return Vec3(body.points[n[(k + 1) % 3]] - body.points[n[k]]); };
            normal_.push_back(side(0).cross(side(1)).normalized());
            for (int k = 0; k < 3; ++k) {
                at_edge_[edges_.of_triangle[t][k]] += normal_.back();
                const Vec3 before = -side((k + 2) % 3), after = side(k);
                at_point_[n[k]] += std::atan2(after.cross(before).norm(), after.dot(before)) * normal_.back();
            }
        }
    }

    double operator()(const Vec3& p) const {
        double squared = std::numeric_limits<double>::infinity();
        const auto nearest = [&](int t) {
            const auto& [a, b, c] = body_.triangles[t];
            return nearest_point_triangle(p, body_.points[a], body_.points[b], body_.points[c]);
        };
        const int t = tree_.nearest(p, squared, [&](int i) { return nearest(i).squared; });
        const Nearest n = nearest(t);
        const Triangle& corner = body_.triangles[t];
        Vec3 on = Vec3::Zero(), normal = normal_[t];
        int count = 0, last = 0, absent = 0;
        for (int k = 0; k < 3; ++k) {
            on += n.weight[k + 1] * body_.points[corner[k]];
            const bool takes_part = n.weight[k + 1] > 0;
            count += takes_part;
            (takes_part ? last : absent) = k;
        }
        if (count == 2) normal = at_edge_[edges_.of_triangle[t][absent]];
        if (count == 1) normal = at_point_[corner[last]];
        return (p - on).dot(normal) < 0 ? -std::sqrt(squared) : std::sqrt(squared);
    }

private:
    const TriMesh& body_;
    Bvh tree_;
    EdgeTable edges_;
    std::vector<Vec3> normal_, at_edge_, at_point_;
};

} // namespace

TriMesh offset_surface(const TriMesh& body, double offset, double edge) {
    const SignedDistance distance(body);
    Eigen::AlignedBox3d box;
    for (const Vec3& p : body.points) box.extend(p);
    const Vec3 margin = Vec3::Constant(offset + 4 * edge);
    IsosurfaceOptions options;
    options.cell = edge;
    return isosurface([&](const Vec3& p) { return distance(p) - offset; }, {box.min() - margin, box.max() + margin}, options);
}

} // namespace toile
