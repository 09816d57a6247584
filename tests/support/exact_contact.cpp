// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/exact_contact.h"

#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace toile::test {

namespace {

using Integer = mpz_class;

/// A polynomial in t with whole coefficients, that of t^0 first; empty for zero, the last one not zero.
using Poly = std::vector<Integer>;

Poly trimmed(Poly p) {
    while (!p.empty() && p.back() == 0)
        p.pop_back();
    return p;
}

Poly operator-(const Poly& a, const Poly& b) {
    Poly sum = a;
    sum.resize(std::max(a.size(), b.size()));
    for (std::size_t i = 0; i < b.size(); ++i)
        sum[i] -= b[i];
    return trimmed(std::move(sum));
}

Poly operator+(const Poly& a, const Poly& b) {
    Poly sum = a;
    sum.resize(std::max(a.size(), b.size()));
    for (std::size_t i = 0; i < b.size(); ++i)
        sum[i] += b[i];
    return trimmed(std::move(sum));
}

Poly operator*(const Poly& a, const Poly& b) {
    if (a.empty() || b.empty()) return {};
    Poly product(a.size() + b.size() - 1);
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j)
            product[i + j] += a[i] * b[j];
    return product;
}

Poly derivative(const Poly& p) {
    Poly d;
    for (std::size_t i = 1; i < p.size(); ++i)
        d.push_back(p[i] * Integer(i));
    return d;
}

/// The same polynomial but for a positive factor that its coefficients have in common.
Poly primitive(Poly p) {
    Integer common = 0;
    for (const Integer& v : p)
        common = gcd(common, v);
    if (common > 1)
        for (Integer& v : p)
            v /= common;
    return p;
}

/// Quotient and remainder of c a by b, where c is a whole number other than zero.
std::pair<Poly, Poly> divide(Poly a, const Poly& b) {
    Poly quotient(a.size() >= b.size() ? a.size() - b.size() + 1 : 0);
    while (a.size() >= b.size()) {
        const std::size_t shift = a.size() - b.size();
        const Integer lead = a.back();
        for (Integer& v : a)
            v *= b.back();
        for (Integer& v : quotient)
            v *= b.back();
        quotient[shift] += lead;
        for (std::size_t i = 0; i < b.size(); ++i)
            a[i + shift] -= lead * b[i];
        a = trimmed(std::move(a));
    }
    return {trimmed(std::move(quotient)), std::move(a)};
}

Poly common_divisor(Poly a, Poly b) {
    while (!b.empty()) {
        Poly rest = primitive(divide(std::move(a), b).second);
        a = std::move(b);
        b = std::move(rest);
    }
    return primitive(std::move(a));
}

/// p(t + 1)
Poly shifted(Poly p) {
    for (int i = 0; i + 1 < int(p.size()); ++i)
        for (int j = int(p.size()) - 2; j >= i; --j)
            p[j] += p[j + 1];
    return p;
}

/// 2^n p(t / 2)
Poly halved(Poly p) {
    for (std::size_t i = 0; i < p.size(); ++i)
        p[i] <<= p.size() - 1 - i;
    return p;
}

int sign_at_zero(const Poly& p) {
    return p.empty() ? 0 : sgn(p[0]);
}

int sign_at_one(const Poly& p) {
    Integer sum = 0;
    for (const Integer& v : p)
        sum += v;
    return sgn(sum);
}

/// Changes of sign among the Bernstein coefficients on [0, 1]: none or one tell the number of roots in (0,
/// 1), others exceed it by an even number (Descartes). `sign` is that of the polynomial in (0, 1) when there
/// are none.
struct Variations {
    int count = 0, sign = 0;
};

Variations variations(Poly p) {
    std::reverse(p.begin(), p.end());
    Variations v;
    for (const Integer& c : shifted(std::move(p))) {
        if (sgn(c) == 0) continue;
        v.count += v.sign != 0 && sgn(c) != v.sign;
        v.sign = sgn(c);
    }
    return v;
}

/// A root in [0, 1]: (place + s) / 2^depth with s = 0 when it is `exact`, otherwise the only s in (0, 1) at
/// which `local` is zero, simply.
struct Root {
    Poly of; ///< without multiple roots
    Poly local;
    Integer place;
    int depth = 0;
    bool exact = false;

    void refine() {
        const Poly left = halved(local);
        place *= 2;
        ++depth;
        if (sign_at_one(left) == 0) {
            place += 1;
            exact = true;
        } else if (variations(left).count % 2) {
            local = left;
        } else {
            local = shifted(left);
            place += 1;
        }
    }

    /// c p((place + s) / 2^depth) as a polynomial in s, c positive.
    Poly seen_from_here(Poly p) const {
        for (std::size_t i = 0; i < p.size(); ++i)
            p[i] <<= std::size_t(depth) * (p.size() - 1 - i);
        for (int i = 0; i + 1 < int(p.size()); ++i)
            for (int j = int(p.size()) - 2; j >= i; --j)
                p[j] += place * p[j + 1];
        return p;
    }
};

void find_roots(const Poly& of, const Poly& local, const Integer& place, int depth,
                std::vector<Root>& roots) {
    const int n = variations(local).count;
    if (n == 0) return;
    if (n == 1) {
        roots.push_back({of, local, place, depth, false});
        return;
    }
    const Poly left = halved(local);
    find_roots(of, left, 2 * place, depth + 1, roots);
    if (sign_at_one(left) == 0) roots.push_back({of, left, 2 * place + 1, depth + 1, true});
    find_roots(of, shifted(left), 2 * place + 1, depth + 1, roots);
}

/// The roots in [0, 1] of a polynomial that is not zero, each once: by bisection and Descartes' rule (Collins
/// and Akritas, Polynomial real root isolation using Descartes' rule of signs, 1976).
std::vector<Root> roots_in_step(const Poly& p) {
    std::vector<Root> roots;
    if (p.size() < 2 || (sign_at_zero(p) && sign_at_one(p) && variations(p).count == 0)) return roots;
    const Poly simple = primitive(divide(p, common_divisor(p, derivative(p))).first);
    if (sign_at_zero(simple) == 0) roots.push_back({simple, simple, 0, 0, true});
    find_roots(simple, simple, 0, 0, roots);
    if (sign_at_one(simple) == 0) roots.push_back({simple, simple, 1, 0, true});
    return roots;
}

/// Of p at a root. Where p shares the root, their common divisor has it too; otherwise p keeps its sign once
/// the interval is small enough.
int sign(const Poly& p, Root t) {
    if (p.size() < 2) return sign_at_zero(p);
    Poly common;
    for (int steps = 2;; steps *= 2) {
        const Poly here = t.seen_from_here(p);
        if (t.exact) return sign_at_zero(here);
        const Variations v = variations(here);
        if (v.count == 0) return v.sign;
        if (steps >= 16) {
            if (common.empty()) common = common_divisor(t.of, p);
            if (common.size() > 1 && variations(t.seen_from_here(common)).count == 1) return 0;
        }
        for (int k = 0; k < steps && !t.exact; ++k)
            t.refine();
    }
}

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

} // namespace toile::test
