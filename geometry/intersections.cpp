// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/intersections.h"

#include "geometry/bvh.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Intersections_3/Point_3_Segment_3.h>
#include <CGAL/Intersections_3/Point_3_Triangle_3.h>
#include <CGAL/Intersections_3/Segment_3_Segment_3.h>
#include <CGAL/Intersections_3/Segment_3_Triangle_3.h>
#include <CGAL/Intersections_3/Triangle_3_Triangle_3.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <variant>

namespace toile {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Segment = Kernel::Segment_3;
using Face = Kernel::Triangle_3;
using Shape = std::variant<Point, Segment, Face>;
using Pairs = std::vector<std::array<int, 2>>;

Point to_cgal(const Vec3& p) {
    return {p[0], p[1], p[2]};
}

// What two or three points span: CGAL's predicates require that a segment and a triangle are not degenerate.
Shape span(const Point& a, const Point& b) {
    if (a == b) return a;
    return Segment(a, b);
}

Shape span(const Point& a, const Point& b, const Point& c) {
    if (!CGAL::collinear(a, b, c)) return Face(a, b, c);
    const auto ends = std::minmax({a, b, c}, [](const Point& p, const Point& q) { return p < q; });
    return span(ends.first, ends.second);
}

bool meet(const Point& a, const Point& b) {
    return a == b;
}
template <class A, class B> bool meet(const A& a, const B& b) {
    return CGAL::do_intersect(a, b);
}

bool meet_shapes(const Shape& a, const Shape& b) {
    return std::visit([](const auto& s, const auto& t) { return meet(s, t); }, a, b);
}

struct TriangleBox {
    using NT = double;
    using ID = std::size_t;
    double low[3], high[3];
    int triangle;
    ID unique; // boxes of one id are never reported, not even when they come from different sets

    static int dimension() { return 3; }
    ID id() const { return unique; }
    double min_coord(int d) const { return low[d]; }
    double max_coord(int d) const { return high[d]; }
};

/// Those of the triangles that reach into `region`.
std::vector<TriangleBox> boxes_of(const TriMesh& mesh, std::size_t first_id, const Box& region) {
    std::vector<TriangleBox> boxes;
    boxes.reserve(mesh.triangles.size());
    for (int t = 0; t < int(mesh.triangles.size()); ++t) {
        Box box;
        for (const int i : mesh.triangles[t]) box.extend(mesh.points[i]);
        if (!region.intersects(box)) continue;
        TriangleBox& b = boxes.emplace_back();
        b.triangle = t;
        b.unique = first_id + t;
        for (int d = 0; d < 3; ++d) {
            b.low[d] = box.min()[d];
            b.high[d] = box.max()[d];
        }
    }
    return boxes;
}

Box box_of(const TriMesh& mesh) {
    Box box;
    for (const Triangle& t : mesh.triangles)
        for (const int i : t) box.extend(mesh.points[i]);
    return box;
}

void require_finite(const TriMesh& mesh) {
    for (int i = 0; i < int(mesh.points.size()); ++i)
        if (!mesh.points[i].allFinite())
            throw std::invalid_argument(
                "point " + std::to_string(i) +
                " is not finite, expected finite coordinates to look for intersections");
}

// What every triangle with a box spans. Found once: it costs as much as a test of two triangles.
std::vector<Shape> shapes_of(const TriMesh& m, const std::vector<TriangleBox>& boxes) {
    std::vector<Shape> shapes(m.triangles.size());
    for (const TriangleBox& box : boxes) {
        const auto& [a, b, c] = m.triangles[box.triangle];
        shapes[box.triangle] = span(to_cgal(m.points[a]), to_cgal(m.points[b]), to_cgal(m.points[c]));
    }
    return shapes;
}

// Triangles (u, v, a) and (u, v, b): other than in u v they meet only where they lie on each other.
bool meet_beyond_edge(const Point& u, const Point& v, const Point& a, const Point& b) {
    if (!CGAL::coplanar(u, v, a, b)) return false;
    const bool flat_a = CGAL::collinear(u, v, a), flat_b = CGAL::collinear(u, v, b);
    if (flat_a && flat_b) return meet_shapes(span(u, a), span(u, b)) && meet_shapes(span(v, a), span(v, b));
    if (flat_a || flat_b) return false;
    return CGAL::coplanar_orientation(u, v, a, b) == CGAL::POSITIVE;
}

Shape side_opposite(const TriMesh& m, int t, int corner) {
    const Triangle& k = m.triangles[t];
    return span(to_cgal(m.points[k[(corner + 1) % 3]]), to_cgal(m.points[k[(corner + 2) % 3]]));
}

// Corners that two triangles of a mesh share, and the last corner of each that they do not.
struct Shared {
    int count = 0;
    int corner_a = 0, corner_b = 0; ///< a shared corner
    int free_a = 0, free_b = 0;
};

Shared shared_corners(const Triangle& a, const Triangle& b) {
    Shared s;
    for (int i = 0; i < 3; ++i) {
        const int j = int(std::find(b.begin(), b.end(), a[i]) - b.begin());
        if (j < 3) {
            ++s.count;
            s.corner_a = i;
            s.corner_b = j;
        } else {
            s.free_a = i;
        }
    }
    for (int j = 0; j < 3; ++j)
        if (std::find(a.begin(), a.end(), b[j]) == a.end()) s.free_b = j;
    return s;
}

bool meet_in_mesh(const TriMesh& m, const std::vector<Shape>& shapes, int a, int b) {
    const Triangle &ta = m.triangles[a], &tb = m.triangles[b];
    const Shared shared = shared_corners(ta, tb);
    if (shared.count == 0) return meet_shapes(shapes[a], shapes[b]);
    // What two triangles share beyond a corner lies on straight lines from it, which end on the side opposite
    // the corner in one of the two.
    if (shared.count == 1)
        return meet_shapes(side_opposite(m, a, shared.corner_a), shapes[b]) ||
               meet_shapes(side_opposite(m, b, shared.corner_b), shapes[a]);
    if (shared.count == 2)
        return meet_beyond_edge(to_cgal(m.points[ta[(shared.free_a + 1) % 3]]),
                                to_cgal(m.points[ta[(shared.free_a + 2) % 3]]),
                                to_cgal(m.points[ta[shared.free_a]]), to_cgal(m.points[tb[shared.free_b]]));
    return true;
}

} // namespace

Pairs intersecting_pairs(const TriMesh& a, const TriMesh& b) {
    require_finite(a);
    require_finite(b);
    Pairs pairs;
    const Box common = box_of(a).intersection(box_of(b));
    if (common.isEmpty()) return pairs;
    std::vector<TriangleBox> boxes_a = boxes_of(a, 0, common), boxes_b = boxes_of(b, a.triangles.size(), common);
    const std::vector<Shape> shapes_a = shapes_of(a, boxes_a), shapes_b = shapes_of(b, boxes_b);
    CGAL::box_intersection_d(boxes_a.begin(), boxes_a.end(), boxes_b.begin(), boxes_b.end(),
                             [&](const TriangleBox& s, const TriangleBox& t) {
                                 if (meet_shapes(shapes_a[s.triangle], shapes_b[t.triangle]))
                                     pairs.push_back({s.triangle, t.triangle});
                             });
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

Pairs self_intersecting_pairs(const TriMesh& mesh) {
    require_finite(mesh);
    Pairs pairs;
    std::vector<TriangleBox> boxes = boxes_of(mesh, 0, box_of(mesh));
    const std::vector<Shape> shapes = shapes_of(mesh, boxes);
    CGAL::box_self_intersection_d(boxes.begin(), boxes.end(),
                                  [&](const TriangleBox& s, const TriangleBox& t) {
                                      const auto [low, high] = std::minmax(s.triangle, t.triangle);
                                      if (meet_in_mesh(mesh, shapes, low, high)) pairs.push_back({low, high});
                                  });
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

} // namespace toile
