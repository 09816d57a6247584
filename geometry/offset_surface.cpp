// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/offset_surface.h"

#include "geometry/edges.h"
#include "geometry/foot.h"
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
        const Foot foot = foot_on(body_, tree_, p);
        const Triangle& corner = body_.triangles[foot.triangle];
        Vec3 normal = normal_[foot.triangle];
        int count = 0, last = 0, absent = 0;
        for (int k = 0; k < 3; ++k) {
            const bool takes_part = foot.nearest.weight[k + 1] > 0;
            count += takes_part;
            (takes_part ? last : absent) = k;
        }
        if (count == 2) normal = at_edge_[edges_.of_triangle[foot.triangle][absent]];
        if (count == 1) normal = at_point_[corner[last]];
        const double distance = std::sqrt(foot.nearest.squared);
        return (p - foot.at).dot(normal) < 0 ? -distance : distance;
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
