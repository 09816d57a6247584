// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/inside.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace toile {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Face = Kernel::Triangle_3;
using Faces = std::vector<Face>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Faces::const_iterator>>>;

Kernel::Point_3 in_space(const Vec3& p) { return {p[0], p[1], p[2]}; }
Kernel::Point_2 from_above(const Vec3& p) { return {p[0], p[1]}; }

/// The side of the line a b, seen along z, on which p lies when it is moved by an infinitely small step along x and one
/// smaller still along y. 0: a and b are the same seen so.
int side_of_line(const Vec3& a, const Vec3& b, const Vec3& p) {
    if (const int side = CGAL::orientation(from_above(a), from_above(b), from_above(p)); side != 0) return side;
    const auto sign = [](double from, double to) { return int(to > from) - int(to < from); };
    if (const int side = sign(b[1], a[1]); side != 0) return side;
    return sign(a[0], b[0]);
}

struct RayBox {
    using NT = double;
    using ID = std::size_t;
    Vec3 low, high;
    int item;
    ID unique;

    static int dimension() { return 3; }
    ID id() const { return unique; }
    double min_coord(int d) const { return low[d]; }
    double max_coord(int d) const { return high[d]; }
};

void require_finite(const Points& points) {
    if (!std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); }))
        throw std::invalid_argument("a point is not finite");
}

} // namespace

std::vector<int> winding_numbers(const TriMesh& surface, const Points& points) {
    require_finite(surface.points);
    require_finite(points);
    std::vector<RayBox> rays, boxes;
    for (int i = 0; i < int(points.size()); ++i) {
        rays.push_back({points[i], points[i], i, rays.size()});
        rays.back().high[2] = std::numeric_limits<double>::max();
    }
    for (int t = 0; t < int(surface.triangles.size()); ++t) {
        const auto& [a, b, c] = surface.triangles[t];
        const Vec3 &p = surface.points[a], &q = surface.points[b], &r = surface.points[c];
        boxes.push_back({p.cwiseMin(q).cwiseMin(r), p.cwiseMax(q).cwiseMax(r), t, rays.size() + boxes.size()});
    }
    std::vector<int> winding(points.size(), 0);
    CGAL::box_intersection_d(rays.begin(), rays.end(), boxes.begin(), boxes.end(), [&](const RayBox& ray, const RayBox& box) {
        const Vec3& p = points[ray.item];
        const Triangle& t = surface.triangles[box.item];
        const Vec3 &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
        const int side = side_of_line(a, b, p);
        if (side == 0 || side_of_line(b, c, p) != side || side_of_line(c, a, p) != side) return;
        const int above = -side * CGAL::orientation(in_space(a), in_space(b), in_space(c), in_space(p));
        if (above > 0) winding[ray.item] += side;
    });
    return winding;
}

std::vector<double> surface_distances(const TriMesh& surface, const Points& points) {
    require_finite(surface.points);
    require_finite(points);
    Faces faces;
    for (const auto& [a, b, c] : surface.triangles) {
        const Face face(in_space(surface.points[a]), in_space(surface.points[b]), in_space(surface.points[c]));
        if (!face.is_degenerate()) faces.push_back(face);
    }
    std::vector<double> distances(points.size(), std::numeric_limits<double>::infinity());
    if (faces.empty()) return distances;
    Tree tree(faces.begin(), faces.end());
    tree.accelerate_distance_queries();
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = std::sqrt(tree.squared_distance(in_space(points[i])));
    return distances;
}

} // namespace toile
