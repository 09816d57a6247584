// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/distance.h"

#include <limits>

namespace toile {

namespace {

// Everything below works with the query point at the origin: corner vectors are small where gaps are, and no
// digits are lost to the distance from the world's origin.

struct OnSegment {
    double t;
    double squared;
};

OnSegment origin_on_segment(const Vec3& a, const Vec3& b) {
    const Vec3 ab = b - a;
    const double along = -a.dot(ab), length = ab.squaredNorm();
    if (!(along > 0)) return {0, a.squaredNorm()};
    if (along >= length) return {1, b.squaredNorm()};
    // From the nearer end, so that rounding of t moves the point least.
    const double t = along / length;
    const Vec3 d = t < 0.5 ? Vec3(a + t * ab) : Vec3(b - (1 - t) * ab);
    return {t, d.squaredNorm()};
}

void keep_nearer_segment(Nearest& best, int i, int j, const OnSegment& s) {
    if (s.squared >= best.squared) return;
    const int fixed = best.active & 1;
    best.squared = s.squared;
    best.weight[1] = best.weight[2] = best.weight[3] = 0;
    best.weight[i] = 1 - s.t;
    best.weight[j] = s.t;
    best.active = fixed | (s.t < 1 ? 1 << i : 0) | (s.t > 0 ? 1 << j : 0);
}

// Below this squared sine of the angle of two directions, a solution that divides by it is not trusted alone.
constexpr double nearly_parallel = 1e-12;

// Foot of the perpendicular from the origin on the plane of a triangle, as weights of the corners: the sign
// of each tells on which side of the opposite side it falls.
struct Foot {
    double a, b, c;
    bool sliver; ///< the plane is uncertain, and so are the signs

    bool inside() const { return a > 0 && b > 0 && c > 0; }
};

Foot foot_on_plane(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, bc = c - b;
    const Vec3 n = ab.cross(ac);
    const double area = n.squaredNorm();
    // Each from a corner of its own sub-triangle: far points keep the digits of near corners.
    const double wa = n.dot(b.cross(bc)), wb = n.dot(ac.cross(c)), wc = n.dot(a.cross(ab));
    const double scale = 1 / (wa + wb + wc);
    return {wa * scale, wb * scale, wc * scale,
            !(area > nearly_parallel * ab.squaredNorm() * ac.squaredNorm())};
}

void keep_nearer_end(Nearest& best, int end, int i, int j, const OnSegment& s) {
    if (s.squared >= best.squared) return;
    best.squared = s.squared;
    best.weight = {};
    best.weight[end] = 1;
    best.weight[i] = 1 - s.t;
    best.weight[j] = s.t;
    best.active = 1 << end | (s.t < 1 ? 1 << i : 0) | (s.t > 0 ? 1 << j : 0);
}

} // namespace

double nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    return origin_on_segment(a - p, b - p).t;
}

Nearest nearest_point_triangle(const Vec3& p, const Vec3& a_, const Vec3& b_, const Vec3& c_) {
    const Vec3 a = a_ - p, b = b_ - p, c = c_ - p;
    const Foot foot = foot_on_plane(a, b, c);
    Nearest face;
    const bool inside = foot.inside();
    if (inside) {
        face = {(foot.a * a + foot.b * b + foot.c * c).squaredNorm(), {1, foot.a, foot.b, foot.c}, 0b1111};
        if (!foot.sliver) return face;
    }
    // The nearest point lies on the border, on a side that the foot is beyond.
    Nearest best;
    best.squared = std::numeric_limits<double>::infinity();
    best.weight[0] = 1;
    best.active = 1;
    if (foot.sliver || !(foot.c > 0)) keep_nearer_segment(best, 1, 2, origin_on_segment(a, b));
    if (foot.sliver || !(foot.a > 0)) keep_nearer_segment(best, 2, 3, origin_on_segment(b, c));
    if (foot.sliver || !(foot.b > 0)) keep_nearer_segment(best, 3, 1, origin_on_segment(c, a));
    return inside && face.squared < best.squared ? face : best;
}

Nearest nearest_edge_edge(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
    const Vec3 u = a1 - a0, v = b1 - b0, w = b0 - a0;
    const Vec3 n = u.cross(v);
    const double det = n.squaredNorm();
    const bool parallel = !(det > nearly_parallel * u.squaredNorm() * v.squaredNorm());
    const double s_up = n.dot(w.cross(v)), t_up = n.dot(w.cross(u));
    const bool inside = s_up > 0 && s_up < det && t_up > 0 && t_up < det;
    Nearest crossing;
    if (inside) {
        const double s = s_up / det, t = t_up / det;
        crossing = {(w + t * v - s * u).squaredNorm(), {1 - s, s, 1 - t, t}, 0b1111};
        if (!parallel) return crossing;
    }
    // The nearest points include an end, one that the nearest points of the lines are beyond.
    Nearest best;
    best.squared = std::numeric_limits<double>::infinity();
    if (parallel || s_up <= 0) keep_nearer_end(best, 0, 2, 3, origin_on_segment(w, b1 - a0));
    if (parallel || s_up >= det) keep_nearer_end(best, 1, 2, 3, origin_on_segment(b0 - a1, b1 - a1));
    if (parallel || t_up <= 0) keep_nearer_end(best, 2, 0, 1, origin_on_segment(-w, a1 - b0));
    if (parallel || t_up >= det) keep_nearer_end(best, 3, 0, 1, origin_on_segment(a0 - b1, a1 - b1));
    return inside && crossing.squared < best.squared ? crossing : best;
}

Vec3 gap_point_triangle(const Nearest& n, const std::array<Vec3, 4>& x) {
    return n.weight[1] * (x[1] - x[0]) + n.weight[2] * (x[2] - x[0]) + n.weight[3] * (x[3] - x[0]);
}

Vec3 gap_edge_edge(const Nearest& n, const std::array<Vec3, 4>& x) {
    return (x[2] - x[0]) + n.weight[3] * (x[3] - x[2]) - n.weight[1] * (x[1] - x[0]);
}

std::optional<Passage> segment_through_triangle(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q,
                                                const Vec3& r) {
    const Vec3 normal = (q - p).cross(r - p), direction = b - a;
    const double closing = normal.dot(direction);
    if (closing == 0) return std::nullopt;
    Passage passage;
    passage.along = normal.dot(p - a) / closing;
    if (!(passage.along >= 0 && passage.along <= 1)) return std::nullopt;
    const Vec3 at = a + passage.along * direction;
    const Vec3* corner[] = {&p, &q, &r};
    for (int k = 0; k < 3; ++k)
        passage.corner[k] =
            normal.dot((*corner[(k + 1) % 3] - at).cross(*corner[(k + 2) % 3] - at)) / normal.squaredNorm();
    if (!(passage.corner.minCoeff() >= 0)) return std::nullopt;
    return passage;
}

} // namespace toile
