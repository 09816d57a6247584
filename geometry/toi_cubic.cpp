// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/toi_cubic.h"

#include "geometry/distance.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

struct Cubic {
    std::array<double, 4> c; ///< of t^0 to t^3
    double operator()(double t) const { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); }
};

// det(u, v, w) of three vectors that change linearly: u + t du, and so on.
Cubic determinant(const Vec3& u, const Vec3& v, const Vec3& w, const Vec3& du, const Vec3& dv,
                  const Vec3& dw) {
    const Vec3 n0 = u.cross(v), n1 = u.cross(dv) + du.cross(v), n2 = du.cross(dv);
    return {{n0.dot(w), n0.dot(dw) + n1.dot(w), n1.dot(dw) + n2.dot(w), n2.dot(dw)}};
}

// Bounds of the pieces of [0, 1] on which the cubic rises or falls, and how many.
std::pair<std::array<double, 4>, int> monotone_pieces(const Cubic& f) {
    std::array<double, 4> at{0};
    int n = 1;
    const double a = 3 * f.c[3], half_b = f.c[2], c = f.c[1];
    const double discriminant = half_b * half_b - a * c;
    if (discriminant > 0) {
        const double q = -(half_b + std::copysign(std::sqrt(discriminant), half_b));
        double first = q / a, second = c / q;
        if (!(first < second)) std::swap(first, second);
        for (const double t : {first, second})
            if (t > at[n - 1] && t < 1) at[n++] = t;
    }
    at[n++] = 1;
    return {at, n};
}

// Bisection to the last bit: the sign changes from `low` to `high`.
double root_between(const Cubic& f, double low, double high) {
    const bool rises = f(high) > 0;
    for (;;) {
        const double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) return high;
        (((f(middle) > 0) == rises) ? high : low) = middle;
    }
}

template <class Inside>
std::optional<double> first_root(const Cubic& f, const Motion& m, const Inside& inside) {
    const auto touches = [&](double t) {
        std::array<Vec3, 4> x;
        for (int k = 0; k < 4; ++k)
            x[k] = m.x[k] + t * m.dx[k];
        return inside(x);
    };
    const auto [at, n] = monotone_pieces(f);
    for (int k = 0; k < n; ++k) {
        if (f(at[k]) == 0 && touches(at[k])) return at[k];
        if (k + 1 == n || !(f(at[k]) * f(at[k + 1]) < 0)) continue;
        const double t = root_between(f, at[k], at[k + 1]);
        if (touches(t)) return t;
    }
    return std::nullopt;
}

} // namespace

std::optional<double> cubic_toi_point_triangle(const Motion& m, double tolerance) {
    const auto& [x, dx] = m;
    const Cubic f =
        determinant(x[2] - x[1], x[3] - x[1], x[0] - x[1], dx[2] - dx[1], dx[3] - dx[1], dx[0] - dx[1]);
    return first_root(f, m, [tolerance](const std::array<Vec3, 4>& at) {
        const Vec3 ab = at[2] - at[1], ac = at[3] - at[1], ap = at[0] - at[1];
        const Vec3 n = ab.cross(ac);
        const double area = n.squaredNorm();
        if (area == 0)
            return nearest_point_triangle(at[0], at[1], at[2], at[3]).squared <= tolerance * tolerance;
        const double b = n.dot(ap.cross(ac)) / area, c = n.dot(ab.cross(ap)) / area;
        const double room = tolerance / std::sqrt(std::max(ab.squaredNorm(), ac.squaredNorm()));
        return b >= -room && c >= -room && b + c <= 1 + room;
    });
}

std::optional<double> cubic_toi_edge_edge(const Motion& m, double tolerance) {
    const auto& [x, dx] = m;
    const Cubic f =
        determinant(x[1] - x[0], x[3] - x[2], x[2] - x[0], dx[1] - dx[0], dx[3] - dx[2], dx[2] - dx[0]);
    return first_root(f, m, [tolerance](const std::array<Vec3, 4>& at) {
        const Vec3 u = at[1] - at[0], v = at[3] - at[2], w = at[2] - at[0];
        const Vec3 n = u.cross(v);
        const double whole = n.squaredNorm();
        if (whole == 0) return nearest_edge_edge(at[0], at[1], at[2], at[3]).squared <= tolerance * tolerance;
        const double s = n.dot(w.cross(v)) / whole, t = n.dot(w.cross(u)) / whole;
        const double along_u = tolerance / u.norm(), along_v = tolerance / v.norm();
        return s >= -along_u && s <= 1 + along_u && t >= -along_v && t <= 1 + along_v;
    });
}

} // namespace toile
