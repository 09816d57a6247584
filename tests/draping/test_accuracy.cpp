// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/accuracy.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace toile;

namespace {

/// How far a drape that is C h^p from its limit is at edge length h, with C = 3.
double off(double h, double p) { return 3 * std::pow(h, p); }

} // namespace

TEST_CASE("three meshes show the order by which a drape nears its limit") {
    for (const double p : {0.5, 1.0, 1.4})
        for (const double c : {0.02, 0.025}) {
            const double a = 0.04, b = 0.03;
            CHECK(measured_order(off(a, p) - off(b, p), off(b, p) - off(c, p), a, b, c) == Approx(p).epsilon(1e-6));
        }
}

TEST_CASE("an order above the assumed one is taken for chance") {
    CHECK(measured_order(off(0.04, 4) - off(0.02, 4), off(0.02, 4) - off(0.01, 4), 0.04, 0.02, 0.01) == assumed_order);
}

TEST_CASE("differences that grow have a negative order") {
    const double p = measured_order(1e-3, 2e-3, 0.04, 0.02, 0.01);
    CHECK(p == Approx(-1));
    CHECK(expected_change(2e-3, 2, p) == Approx(4e-3)); // and go on to grow
}

TEST_CASE("the change to half the edge length follows from the difference so far") {
    for (const double p : {0.5, 1.0, 2.0}) {
        const double before = 0.028, now = 0.02;
        CHECK(expected_change(off(before, p) - off(now, p), before / now, p) == Approx(off(now, p) - off(now / 2, p)));
    }
    CHECK(expected_change(1e-3, 2, 0) == Approx(1e-3));
}
