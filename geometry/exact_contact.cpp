// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/exact_contact.h"

#include "geometry/exact_roots.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

using exact::operator+;
using exact::operator-;
using exact::operator*;
using exact::Integer;
using exact::Poly;
using exact::Root;
using exact::roots_in_step;
using exact::sign;
using exact::sign_at_zero;
using exact::trimmed;

/// A point that moves linearly: each coordinate a polynomial of degree 1, in units of one power of two.
using Moving = std::array<Poly, 3>;
using Four = std::array<Moving, 4>;

Moving operator-(const Moving& a, const Moving& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Moving cross(const Moving& a, const Moving& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Poly dot(const Moving& a, const Moving& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// When a point lies on a segment: `line` is zero (they are collinear) and `beyond` is not positive.
struct OnSegment {
    Moving line;
    Poly beyond;

    OnSegment(const Moving& p, const Moving& a, const Moving& b)
        : line(cross(p - a, p - b)), beyond(dot(p - a, p - b)) {}

    template <class Sign> bool holds(const Sign& sign_of) const {
        for (const Poly& p : line)
            if (sign_of(p) != 0) return false;
        return sign_of(beyond) <= 0;
    }

    /// At any time of the step.
    bool ever() const {
        const auto one = std::find_if(line.begin(), line.end(), [](const Poly& p) { return !p.empty(); });
        if (one != line.end()) {
            const auto roots = roots_in_step(*one);
            return std::any_of(roots.begin(), roots.end(), [&](const Root& t) {
                return holds([&](const Poly& p) { return sign(p, t); });
            });
        }
        // Always collinear: `beyond` starts at or below zero, or comes down to it.
        return sign_at_zero(beyond) <= 0 || !roots_in_step(beyond).empty();
    }
};

/// What decides about contact at a time at which the four points are coplanar (`coplanar` is zero).
struct Contact {
    Poly coplanar;
    /// Contact where none is negative and one is positive. They add up to multiples of the squared normal, so
    /// all are zero where there is no normal: the triangle has no area, or the edges are parallel.
    std::vector<Poly> inside;
    std::vector<OnSegment> on_edges; ///< without a normal: contact where one holds

    template <class Sign> bool holds(const Sign& sign_of) const {
        bool positive = false;
        for (const Poly& p : inside) {
            const int s = sign_of(p);
            if (s < 0) return false;
            positive |= s > 0;
        }
        return positive || std::any_of(on_edges.begin(), on_edges.end(),
                                       [&](const OnSegment& s) { return s.holds(sign_of); });
    }
};

Contact point_triangle(const Four& x) {
    const Moving &p = x[0], &a = x[1], &b = x[2], &c = x[3];
    const Moving n = cross(b - a, c - a);
    return {dot(n, p - a),
            {dot(n, cross(b - p, c - p)), dot(n, cross(c - p, a - p)), dot(n, cross(a - p, b - p))},
            {{p, a, b}, {p, b, c}, {p, c, a}}};
}

Contact edge_edge(const Four& x) {
    const Moving u = x[1] - x[0], v = x[3] - x[2], w = x[2] - x[0];
    const Moving n = cross(u, v);
    const Poly whole = dot(n, n), s = dot(n, cross(w, v)), t = dot(n, cross(w, u));
    return {dot(n, w),
            {s, whole - s, t, whole - t},
            {{x[0], x[2], x[3]}, {x[1], x[2], x[3]}, {x[2], x[0], x[1]}, {x[3], x[0], x[1]}}};
}

bool ever(const Contact& contact) {
    if (!contact.coplanar.empty()) {
        const auto roots = roots_in_step(contact.coplanar);
        return std::any_of(roots.begin(), roots.end(), [&](const Root& t) {
            return contact.holds([&](const Poly& p) { return sign(p, t); });
        });
    }
    // Coplanar all the time: a contact that does not exist from the start begins where a point comes to lie
    // on an edge, since one that is inside a triangle, or where two edges cross between their ends, was so
    // before.
    return contact.holds(sign_at_zero) || std::any_of(contact.on_edges.begin(), contact.on_edges.end(),
                                                      [](const OnSegment& s) { return s.ever(); });
}

Integer scaled(double v, int exponent) {
    int e;
    const double mantissa = std::frexp(v, &e);
    const Integer i(std::ldexp(mantissa, 53)); // a whole number
    return v == 0 ? i : Integer(i << (e - 53 - exponent));
}

/// The power of two of which every finite double in question is a multiple.
int common_exponent(const std::array<Vec3, 4>& a, const std::array<Vec3, 4>& b) {
    int least = 1024;
    for (const auto* x : {&a, &b})
        for (const Vec3& p : *x)
            for (const double v : p) {
                int e;
                if (std::frexp(v, &e) != 0) least = std::min(least, e - 53);
            }
    return least;
}

bool touch(PairKind kind, const Four& x) {
    return ever(kind == PairKind::point_triangle ? point_triangle(x) : edge_edge(x));
}

// Doubles prove most misses: when all four Bernstein coefficients of the cubic have one sign by more than the
// rounding of everything, it has no root in the step. With eps = 2^-53 and L the largest coordinate, an edge
// is wrong by 4 eps L at most in a coordinate (its ends, then their difference) that is itself below 2 L. A
// determinant has 6 products of three of them, each wrong by 8 L^3 (3 * 2 + 5) eps, and the mean of three is
// no worse but for 3 eps more of 48 L^3: below 2^-42.5 L^3 in all. The bound asked for is five times that.
bool surely_apart(PairKind kind, const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to) {
    double largest = 0;
    std::array<std::array<Vec3, 3>, 2> e; // three edges that span the four points, at both ends
    for (int end = 0; end < 2; ++end) {
        const auto& x = end ? to : from;
        for (const Vec3& p : x)
            largest = std::max(largest, p.cwiseAbs().maxCoeff());
        if (kind == PairKind::point_triangle)
            e[end] = {x[1] - x[0], x[2] - x[0], x[3] - x[0]};
        else
            e[end] = {x[1] - x[0], x[3] - x[2], x[2] - x[0]};
    }
    const double bound = 0x1p-40 * largest * largest * largest;
    if (!(bound > 1e-200 && bound < 1e200)) return false;
    const auto det = [&](int i, int j, int k) { return e[i][0].dot(e[j][1].cross(e[k][2])); };
    const double b[] = {det(0, 0, 0), (det(1, 0, 0) + det(0, 1, 0) + det(0, 0, 1)) / 3,
                        (det(0, 1, 1) + det(1, 0, 1) + det(1, 1, 0)) / 3, det(1, 1, 1)};
    return std::all_of(b, b + 4, [&](double v) { return v > bound; }) ||
           std::all_of(b, b + 4, [&](double v) { return v < -bound; });
}

} // namespace

bool exactly_touch(PairKind kind, const Motion& m) {
    std::array<Vec3, 4> to;
    for (int k = 0; k < 4; ++k)
        to[k] = m.x[k] + m.dx[k];
    if (surely_apart(kind, m.x, to)) return false;
    const int unit = common_exponent(m.x, m.dx);
    Four x;
    for (int k = 0; k < 4; ++k)
        for (int c = 0; c < 3; ++c)
            x[k][c] = trimmed({scaled(m.x[k][c], unit), scaled(m.dx[k][c], unit)});
    return touch(kind, x);
}

bool exactly_touch(PairKind kind, const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to) {
    if (surely_apart(kind, from, to)) return false;
    const int unit = common_exponent(from, to);
    Four x;
    for (int k = 0; k < 4; ++k)
        for (int c = 0; c < 3; ++c) {
            const Integer start = scaled(from[k][c], unit);
            x[k][c] = trimmed({start, scaled(to[k][c], unit) - start});
        }
    return touch(kind, x);
}

namespace {

double time_of_impact(PairKind kind, const Motion& m, const ToiOptions& options) {
    return kind == PairKind::point_triangle ? time_of_impact_point_triangle(m, options)
                                            : time_of_impact_edge_edge(m, options);
}

bool is_finite(const std::array<Vec3, 4>& x) {
    return std::all_of(x.begin(), x.end(), [](const Vec3& p) { return p.allFinite(); });
}

} // namespace

std::optional<double> time_of_contact(PairKind kind, const Motion& m, const ToiOptions& options) {
    const double t = time_of_impact(kind, m, options);
    if (t >= 1 || (is_finite(m.x) && is_finite(m.dx) && !exactly_touch(kind, m))) return {};
    return t;
}

std::optional<double> time_of_contact(PairKind kind, const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to,
                                      const ToiOptions& options) {
    // Differences are rounded by no more than the writing down of places, which is allowed for.
    const Motion m{from, {to[0] - from[0], to[1] - from[1], to[2] - from[2], to[3] - from[3]}};
    const double t = time_of_impact(kind, m, options);
    if (t >= 1 || (is_finite(from) && is_finite(to) && !exactly_touch(kind, from, to))) return {};
    return t;
}

} // namespace toile
