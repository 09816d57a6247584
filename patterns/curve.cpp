// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/curve.h"

#include <algorithm>
#include <cmath>

namespace toile {
namespace {

double cross(const Vec2& a, const Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}

Vec2 turned(const Vec2& v, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

/// A Bezier curve in power form about its start, which keeps short curves far from the origin accurate:
/// B(u) = start + c1 u + c2 u^2 + c3 u^3.
struct Polynomial {
    Vec2 c1, c2, c3;

    Vec2 offset(double u) const { return u * (c1 + u * (c2 + u * c3)); }
    Vec2 derivative(double u) const { return c1 + u * (2 * c2 + u * (3 * c3)); }
    Vec2 second(double u) const { return 2 * c2 + u * (6 * c3); }
};

Polynomial polynomial(const Edge& e, const Quadratic& q) {
    const Vec2 a = q.control - e.start, b = e.end - e.start;
    return {2 * a, b - 2 * a, Vec2::Zero()};
}

Polynomial polynomial(const Edge& e, const Cubic& k) {
    const Vec2 a = k.control0 - e.start, b = k.control1 - e.start, c = e.end - e.start;
    return {3 * a, 3 * (b - 2 * a), c + 3 * (a - b)};
}

/// Gauss-Legendre with 8 points on [u0, u1].
double quadrature(const Polynomial& p, double u0, double u1) {
    static constexpr double x[] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                   0.9602898564975363};
    static constexpr double w[] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                   0.1012285362903763};
    const double middle = 0.5 * (u0 + u1), half = 0.5 * (u1 - u0);
    double sum = 0;
    for (int i = 0; i < 4; ++i)
        sum += w[i] * (p.derivative(middle - half * x[i]).norm() + p.derivative(middle + half * x[i]).norm());
    return half * sum;
}

/// Arc length of a Bezier curve as a table over cells that are narrow where the speed changes fast.
class LengthTable {
public:
    explicit LengthTable(const Polynomial& p) : p_(p) {
        u_.push_back(0);
        s_.push_back(0);
        add(0, 1, quadrature(p_, 0, 1), 0);
    }

    double total() const { return s_.back(); }

    /// Parameter at arc length s. Newton, kept inside a shrinking bracket: a cusp has no speed to divide by.
    double parameter(double s) const {
        if (s <= 0) return 0;
        if (s >= total()) return 1;
        const int cell = int(std::upper_bound(s_.begin(), s_.end(), s) - s_.begin()) - 1;
        const double u0 = u_[cell], rest = s - s_[cell];
        double low = u0, high = u_[cell + 1];
        double u = u0 + (high - u0) * rest / (s_[cell + 1] - s_[cell]);
        for (int k = 0; k < 60 && high - low > 1e-16; ++k) {
            const double miss = quadrature(p_, u0, u) - rest;
            (miss > 0 ? high : low) = u;
            const double speed = p_.derivative(u).norm();
            const double next = u - miss / speed;
            if (next == u) break;
            u = next > low && next < high ? next : 0.5 * (low + high);
        }
        return u;
    }

private:
    void add(double u0, double u1, double whole, int depth) {
        const double middle = 0.5 * (u0 + u1);
        const double left = quadrature(p_, u0, middle), right = quadrature(p_, middle, u1);
        const bool fine = std::abs(left + right - whole) <= 1e-14 * (left + right + s_.back());
        if (depth < 40 && !fine) {
            add(u0, middle, left, depth + 1);
            add(middle, u1, right, depth + 1);
            return;
        }
        u_.push_back(u1);
        s_.push_back(s_.back() + left + right);
    }

    Polynomial p_;
    std::vector<double> u_, s_;
};

bool finite(const Polynomial& p) {
    return p.c1.allFinite() && p.c2.allFinite() && p.c3.allFinite();
}

double bezier_length(const Polynomial& p) {
    return finite(p) ? LengthTable(p).total() : std::numeric_limits<double>::quiet_NaN();
}

Vec2 arc_point(const Edge& e, const ArcTurn& t, double u) {
    // The chord from the start: accurate for the flattest of arcs, where a centre would be far away.
    const double half = 0.5 * u * t.angle;
    return e.start + 2 * t.radius * std::abs(std::sin(half)) * turned(t.first, half);
}

/// Unclamped point at u, strictly inside the edge.
struct PointAt {
    const Edge& e;
    double u;
    Vec2 operator()(const Straight&) const { return e.start + u * (e.end - e.start); }
    Vec2 operator()(const Quadratic& q) const { return e.start + polynomial(e, q).offset(u); }
    Vec2 operator()(const Cubic& k) const { return e.start + polynomial(e, k).offset(u); }
    Vec2 operator()(const Arc& a) const { return arc_point(e, turn_of(e, a), u); }
};

struct TangentAt {
    const Edge& e;
    double u;
    Vec2 operator()(const Straight&) const { return e.end - e.start; }
    Vec2 operator()(const Quadratic& q) const { return along(polynomial(e, q)); }
    Vec2 operator()(const Cubic& k) const { return along(polynomial(e, k)); }
    Vec2 operator()(const Arc& a) const {
        const ArcTurn t = turn_of(e, a);
        return turned(t.first, u * t.angle);
    }
    /// A control point on an end leaves no first derivative there; the second tells where the curve goes.
    Vec2 along(const Polynomial& p) const {
        const Vec2 d = p.derivative(u);
        const double size = p.c1.norm() + p.c2.norm() + p.c3.norm();
        if (d.norm() > 1e-12 * size) return d;
        const Vec2 second = p.second(u);
        const Vec2 way = second.norm() > 1e-12 * size ? second : Vec2(6 * p.c3);
        return u < 0.5 || second.norm() <= 1e-12 * size ? way : Vec2(-way);
    }
};

struct LengthOf {
    const Edge& e;
    double operator()(const Straight&) const { return (e.end - e.start).norm(); }
    double operator()(const Quadratic& q) const { return bezier_length(polynomial(e, q)); }
    double operator()(const Cubic& k) const { return bezier_length(polynomial(e, k)); }
    double operator()(const Arc& a) const {
        const ArcTurn t = turn_of(e, a);
        return t.radius * std::abs(t.angle);
    }
};

/// Curve parameters at the given fractions of arc length.
struct Parameters {
    const Edge& e;
    std::vector<double> fractions;
    std::vector<double> operator()(const Straight&) const { return fractions; }
    std::vector<double> operator()(const Arc&) const { return fractions; }
    std::vector<double> operator()(const Quadratic& q) const { return invert(polynomial(e, q)); }
    std::vector<double> operator()(const Cubic& k) const { return invert(polynomial(e, k)); }
    std::vector<double> invert(const Polynomial& p) const {
        if (!finite(p)) return fractions;
        const LengthTable table(p);
        std::vector<double> u;
        u.reserve(fractions.size());
        for (double t : fractions)
            u.push_back(t <= 0 ? 0 : t >= 1 ? 1 : table.parameter(t * table.total()));
        return u;
    }
};

/// Twice the area between the edge's chord and the edge, positive where the edge bulges to the right of
/// travel.
struct Bulge {
    const Edge& e;
    double operator()(const Straight&) const { return 0; }
    double operator()(const Quadratic& q) const {
        return 2.0 / 3.0 * cross(q.control - e.start, e.end - e.start);
    }
    double operator()(const Cubic& k) const {
        const Vec2 a = k.control0 - e.start, b = k.control1 - e.start, c = e.end - e.start;
        return (3 * cross(a, b) + 3 * cross(a, c) + 6 * cross(b, c)) / 10;
    }
    double operator()(const Arc& a) const {
        const ArcTurn t = turn_of(e, a);
        return t.radius * t.radius * (t.angle - std::sin(t.angle));
    }
};

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 d = b - a;
    const double dd = d.squaredNorm();
    const double t = dd > 0 ? std::clamp((p - a).dot(d) / dd, 0.0, 1.0) : 0;
    return (p - a - t * d).norm();
}

std::vector<double> equal_fractions(double t0, double t1, int n) {
    std::vector<double> fractions(n + 1);
    for (int i = 0; i <= n; ++i)
        fractions[i] = i == n ? t1 : t0 + (t1 - t0) * i / n;
    return fractions;
}

/// Largest distance of the curve from its polyline with n intervals. Looked at in steps of the parameter,
/// which are short where the curve turns sharply.
double sag(const Edge& edge, int n) {
    constexpr int parts = 16;
    const std::vector<double> u = std::visit(Parameters{edge, equal_fractions(0, 1, n)}, edge.curve);
    double worst = 0;
    for (int i = 0; i < n; ++i) {
        const Vec2 a = point_at(edge, u[i]), b = point_at(edge, u[i + 1]);
        for (int k = 1; k < parts; ++k)
            worst = std::max(worst,
                             distance_to_segment(point_at(edge, u[i] + (u[i + 1] - u[i]) * k / parts), a, b));
    }
    return worst;
}

} // namespace

ArcTurn turn_of(const Edge& edge, const Arc& arc) {
    const Vec2 chord = edge.end - edge.start;
    const double d = chord.norm();
    ArcTurn t;
    t.radius = std::max(arc.radius, 0.5 * d);
    if (d == 0) return t;
    const double half = std::asin(std::min(1.0, 0.5 * d / t.radius));
    t.angle = arc.large ? 2 * (EIGEN_PI - half) : 2 * half;
    if (!arc.right) t.angle = -t.angle;
    t.first = turned(chord / d, -0.5 * t.angle);
    return t;
}

Vec2 point_at(const Edge& edge, double u) {
    if (u <= 0) return edge.start;
    if (u >= 1) return edge.end;
    return std::visit(PointAt{edge, u}, edge.curve);
}

Vec2 tangent_at(const Edge& edge, double u) {
    const Vec2 d = std::visit(TangentAt{edge, std::clamp(u, 0.0, 1.0)}, edge.curve);
    const double n = d.norm();
    return n > 0 ? Vec2(d / n) : Vec2(Vec2::Zero());
}

double length(const Edge& edge) {
    return std::visit(LengthOf{edge}, edge.curve);
}

double length(const Loop& loop) {
    double sum = 0;
    for (const Edge& e : loop)
        sum += length(e);
    return sum;
}

std::vector<Vec2> points_at(const Edge& edge, const std::vector<double>& fractions) {
    std::vector<Vec2> points;
    points.reserve(fractions.size());
    for (double u : std::visit(Parameters{edge, fractions}, edge.curve))
        points.push_back(point_at(edge, u));
    return points;
}

std::vector<Vec2> sample(const Edge& edge, double t0, double t1, int n) {
    return points_at(edge, equal_fractions(t0, t1, n));
}

int intervals_for_sag(const Edge& edge, double tolerance) {
    constexpr int most = 4096;
    if (std::holds_alternative<Straight>(edge.curve)) return 1;
    int n = 1;
    for (double s = sag(edge, n); s > tolerance && n < most; s = sag(edge, n)) {
        const double next = std::ceil(n * std::sqrt(s / tolerance)); // a chord's sag falls with its square
        n = next < most ? std::max(n + 1, int(next)) : most;
    }
    return n;
}

Edge reversed(const Edge& edge) {
    Edge r{edge.end, edge.start, edge.curve, edge.label};
    if (auto* k = std::get_if<Cubic>(&r.curve)) std::swap(k->control0, k->control1);
    if (auto* a = std::get_if<Arc>(&r.curve)) a->right = !a->right;
    return r;
}

double signed_area(const Loop& loop) {
    if (loop.empty()) return 0;
    const Vec2 origin = loop.front().start; // near the panel, so that a far-away one loses no digits
    double twice = 0;
    for (const Edge& e : loop)
        twice += cross(e.start - origin, e.end - origin) + std::visit(Bulge{e}, e.curve);
    return 0.5 * twice;
}

} // namespace toile
