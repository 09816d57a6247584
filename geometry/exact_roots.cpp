// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/exact_roots.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace toile::exact {

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

int sign_at_zero(const Poly& p) {
    return p.empty() ? 0 : sgn(p[0]);
}

namespace {

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

} // namespace

void Root::refine() {
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

Poly Root::seen_from_here(Poly p) const {
    for (std::size_t i = 0; i < p.size(); ++i)
        p[i] <<= std::size_t(depth) * (p.size() - 1 - i);
    for (int i = 0; i + 1 < int(p.size()); ++i)
        for (int j = int(p.size()) - 2; j >= i; --j)
            p[j] += place * p[j + 1];
    return p;
}

namespace {

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

} // namespace

std::vector<Root> roots_in_step(const Poly& p) {
    std::vector<Root> roots;
    if (p.size() < 2 || (sign_at_zero(p) && sign_at_one(p) && variations(p).count == 0)) return roots;
    const Poly simple = primitive(divide(p, common_divisor(p, derivative(p))).first);
    if (sign_at_zero(simple) == 0) roots.push_back({simple, simple, 0, 0, true});
    find_roots(simple, simple, 0, 0, roots);
    if (sign_at_one(simple) == 0) roots.push_back({simple, simple, 1, 0, true});
    return roots;
}

// Where p shares the root, their common divisor has it too; otherwise p keeps its sign once the
// interval is small enough.
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

} // namespace toile::exact
