// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Polynomials with whole coefficients, their roots in [0, 1], and signs at these, without rounding (GMP). For
// geometry/exact_contact.cpp.

#include <gmpxx.h>

#include <vector>

namespace toile::exact {

using Integer = mpz_class;

/// A polynomial in t, the coefficient of t^0 first; empty for zero, the last one not zero.
using Poly = std::vector<Integer>;

Poly trimmed(Poly p); ///< without leading zeros
Poly operator-(const Poly& a, const Poly& b);
Poly operator+(const Poly& a, const Poly& b);
Poly operator*(const Poly& a, const Poly& b);

int sign_at_zero(const Poly& p);

/// A root in [0, 1]: (place + s) / 2^depth with s = 0 when it is `exact`, otherwise the only s in (0, 1) at
/// which `local` is zero, simply.
struct Root {
    Poly of; ///< without multiple roots
    Poly local;
    Integer place;
    int depth = 0;
    bool exact = false;

    void refine(); ///< halves the interval
    /// c p((place + s) / 2^depth) as a polynomial in s, c positive.
    Poly seen_from_here(Poly p) const;
};

/// The roots in [0, 1] of a polynomial that is not zero, each once: by bisection and Descartes' rule (Collins
/// and Akritas, Polynomial real root isolation using Descartes' rule of signs, 1976).
std::vector<Root> roots_in_step(const Poly& p);

/// Of p at a root.
int sign(const Poly& p, Root t);

} // namespace toile::exact
