// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/unfold.h"

#include <algorithm>

namespace toile {

namespace {

std::array<Vec2, 3> rest_corners(const Garment& garment, int t) {
    const Mat2& e = garment.rest.edges[t];
    return {Vec2(0, 0), Vec2(e.col(0)), Vec2(e.col(1))};
}

// A new point unless the node is there already: round a dart's tip a node is met twice, in two places, and
// the nearer one is kept.
void add_point(Unfolding& unfolding, const RestPoint& point) {
    for (const RestPoint& p : unfolding.points)
        if (p.node == point.node) return;
    unfolding.points.push_back(point);
}

// Where `corner` of a triangle lies when its edge (corner + 1, corner + 2) is laid on that from a to b, on
// the side away from `inside`. The two edges differ in length where a seam is eased.
Vec2 lay(const std::array<Vec2, 3>& rest, int corner, bool reversed, const Vec2& a, const Vec2& b,
         const Vec2& inside) {
    Vec2 p = rest[(corner + 1) % 3], q = rest[(corner + 2) % 3];
    if (reversed) std::swap(p, q);
    const Vec2 along = q - p, to = rest[corner] - p;
    const double length = along.norm();
    const double height = std::abs(along.x() * to.y() - along.y() * to.x()) / length;
    const Vec2 line = b - a;
    Vec2 out = Vec2(line.y(), -line.x()).normalized();
    if (out.dot(inside - a) > 0) out = -out;
    return a + line * (to.dot(along) / (length * length)) + out * height;
}

} // namespace

Unfolding start_unfolding(const Garment& garment, int t) {
    Unfolding unfolding;
    const Triangle nodes = garment.nodes(t);
    const std::array<Vec2, 3> rest = rest_corners(garment, t);
    unfolding.triangles.push_back({t, {}});
    for (int k = 0; k < 3; ++k) {
        unfolding.triangles[0].corners[k] = {nodes[k], rest[k]};
        unfolding.points.push_back({nodes[k], rest[k]});
    }
    return unfolding;
}

int neighbour(const Garment& garment, int t, int k) {
    const EdgeTable& edges = garment.edges;
    const int e = edges.of_triangle[t][k];
    if (edges.triangles_at(e) != 2 || is_crease(garment, e)) return -1;
    const int a = edges.incident[edges.first[e]], b = edges.incident[edges.first[e] + 1];
    if (a == b) return -1;
    return a == t ? b : a;
}

void unfold_over(const Garment& garment, Unfolding& unfolding, int i, int k) {
    const Unfolding::Placed from = unfolding.triangles[i];
    const int t = neighbour(garment, from.triangle, k);
    if (t < 0) return;
    for (const auto& placed : unfolding.triangles)
        if (placed.triangle == t) return;
    const int e = garment.edges.of_triangle[from.triangle][k];
    const auto& edges_of_t = garment.edges.of_triangle[t];
    const int corner = int(std::find(edges_of_t.begin(), edges_of_t.end(), e) - edges_of_t.begin());
    const RestPoint &a = from.corners[(k + 1) % 3], &b = from.corners[(k + 2) % 3];
    const Triangle nodes = garment.nodes(t);
    const bool reversed = nodes[(corner + 1) % 3] != a.node;
    Unfolding::Placed placed;
    placed.triangle = t;
    placed.corners[corner] = {
        nodes[corner], lay(rest_corners(garment, t), corner, reversed, a.at, b.at, from.corners[k].at)};
    placed.corners[(corner + 1) % 3] = reversed ? b : a;
    placed.corners[(corner + 2) % 3] = reversed ? a : b;
    add_point(unfolding, placed.corners[corner]);
    unfolding.triangles.push_back(placed);
}

void unfold_ring(const Garment& garment, Unfolding& unfolding) {
    const std::size_t first = unfolding.ring, last = unfolding.triangles.size();
    for (std::size_t i = first; i < last; ++i)
        for (int k = 0; k < 3; ++k)
            unfold_over(garment, unfolding, int(i), k);
    unfolding.ring = last;
}

} // namespace toile
