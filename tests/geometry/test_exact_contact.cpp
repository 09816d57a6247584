// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/distance.h"
#include "tests/support/ccd_queries.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace toile;

namespace {

constexpr double ulp = std::numeric_limits<double>::epsilon();

bool point(const Vec3& from, const Vec3& to) {
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
    return exactly_touch(PairKind::point_triangle, {from, a, b, c}, {to, a, b, c});
}

bool edge(const Vec3& b0, const Vec3& b1, const Vec3& motion) {
    const Vec3 a0(-1, 0, 0), a1(1, 0, 0), still(0, 0, 0);
    return exactly_touch(PairKind::edge_edge, Motion{{a0, a1, b0, b1}, {still, still, motion, motion}});
}

} // namespace

TEST_CASE("exact contact tells a point on a triangle's border from one an ulp beside it") {
    CHECK(point({.25, .25, 1}, {.25, .25, -1}));
    CHECK(point({.5, .5, 1}, {.5, .5, -1}));
    CHECK(!point({.5, .5 + ulp, 1}, {.5, .5 + ulp, -1}));
    CHECK(point({0, 0, 1}, {0, 0, -1}));
    CHECK(!point({-0x1p-1000, 0, 1}, {-0x1p-1000, 0, -1}));
    CHECK(point({.25, .25, 1}, {.25, .25, 0}));         // at the end
    CHECK(!point({.25, .25, 1}, {.25, .25, 0x1p-900})); // just not
    CHECK(point({.25, .25, 0}, {.25, .25, 1}));         // at the start
    CHECK(point({-1, .25, 0}, {2, .25, 0}));            // within the plane, across
    CHECK(!point({-1, 2, 0}, {2, 2, 0}));
    CHECK(!point({-1, .25, 0}, {-ulp, .25, 0}));
    CHECK(point({-1, 1, 0}, {1, 1, 0})); // over the corner
    CHECK(!point({-1, 1 + ulp, 0}, {1, 1 + ulp, 0}));
}

TEST_CASE("exact contact of edges that are parallel, collinear or points") {
    CHECK(edge({0, -1, 1}, {0, 1, 1}, {0, 0, -2}));
    CHECK(!edge({1 + ulp, -1, 1}, {1 + ulp, 1, 1}, {0, 0, -2}));
    CHECK(edge({1, 0, 1}, {2, 0, 1}, {0, 0, -2})); // end to end
    CHECK(!edge({1 + ulp, 0, 1}, {2, 0, 1}, {0, 0, -2}));
    CHECK(edge({3, 0, 0}, {2, 0, 0}, {-1, 0, 0})); // along one line
    CHECK(!edge({3, 0, 0}, {2, 0, 0}, {ulp - 1, 0, 0}));
    CHECK(edge({.5, 0, 1}, {.5, 0, 1}, {0, 0, -2})); // a point
    CHECK(edge({-3, 0, 1}, {3, 0, 1}, {0, 0, -1}));
}

TEST_CASE("exact contact knows a double root from none") {
    // At height (2 t - 1)^2 + lift over the face, whose corner c rises by 8: contact at t = 1/2 without lift
    // only.
    const auto graze = [](double lift) {
        const Vec3 a(0, 0, 0), b(1, 0, 0);
        return exactly_touch(PairKind::point_triangle, {Vec3(.125, .75, 1 + lift), a, b, Vec3(0, 1, 0)},
                                   {Vec3(.125, .25, 3 + lift), a, b, Vec3(0, 1, 8)});
    };
    CHECK(graze(0));
    CHECK(!graze(4 * ulp));
    CHECK(graze(-4 * ulp));
}

TEST_CASE("exact contact agrees with distances wherever these are clear") {
    test::Random random(5);
    int touching = 0, apart = 0;
    for (int k = 0; k < 4000; ++k) {
        const PairKind kind = PairKind(k % 2);
        double size;
        const Motion m = test::random_ccd_query(test::CcdFamily::generic, kind, random, size);
        if (size != 1) continue;
        const auto squared = [&](double t) {
            std::array<Vec3, 4> x = m.x;
            for (int i = 0; i < 4; ++i)
                x[i] += t * m.dx[i];
            return kind == PairKind::point_triangle ? nearest_point_triangle(x[0], x[1], x[2], x[3]).squared
                                                    : nearest_edge_edge(x[0], x[1], x[2], x[3]).squared;
        };
        // A motion of length `reach` brings the pair no nearer than its distance less that.
        double least = squared(0), reach = 0;
        for (const Vec3& d : m.dx)
            reach = std::max(reach, 2 * d.norm() / 1000);
        for (int i = 1; i <= 1000; ++i)
            least = std::min(least, squared(i / 1000.));
        const bool touch = exactly_touch(kind, m);
        if (std::sqrt(least) > reach) CHECK(!touch);
        if (touch) CHECK(std::sqrt(least) <= reach);
        touching += touch;
        apart += std::sqrt(least) > reach;
    }
    CHECK(touching > 50);
    CHECK(apart > 1000);
}

TEST_CASE("exact contact finds what is built to touch, and nothing beside it") {
    // All numbers have few bits, so that nothing is rounded: points of the two simplices coincide at t = k / 8. What
    // moves as a whole touches then or never, and an offset along the normal separates it.
    test::Random random(17);
    const auto whole = [&](int range) {
        const int x = random.below(2 * range + 1) - range, y = random.below(2 * range + 1) - range,
                  z = random.below(2 * range + 1) - range;
        return Vec3(x, y, z);
    };
    int parted = 0;
    for (int k = 0; k < 6000; ++k) {
        const PairKind kind = PairKind(k % 2);
        const int first = kind == PairKind::point_triangle ? 1 : 2;
        std::array<Vec3, 4> at;
        for (Vec3& p : at) p = whole(64);
        // In eighths: somewhere inside, on an edge or on a corner.
        const int s = random.below(9), u = random.below(9), v = random.below(9 - u);
        const Vec3 a = first == 1 ? at[0] : Vec3(at[0] + (at[1] - at[0]) * s / 8);
        const Vec3 b = first == 1 ? Vec3(at[1] + ((at[2] - at[1]) * u + (at[3] - at[1]) * v) / 8)
                                  : Vec3(at[2] + (at[3] - at[2]) * u / 8);
        for (int i = 0; i < first; ++i) at[i] += b - a;
        const double t = random.below(9) / 8.;
        const bool together = random.below(2);
        const Vec3 common = whole(64), origin = whole(1) * std::exp2(random.below(30));
        Motion m;
        for (int i = 0; i < 4; ++i) {
            m.dx[i] = together ? common : whole(64);
            m.x[i] = origin + at[i] - t * m.dx[i];
        }
        CHECK(exactly_touch(kind, m));
        const Vec3 n = first == 1 ? Vec3((at[2] - at[1]).cross(at[3] - at[1])) : Vec3((at[1] - at[0]).cross(at[3] - at[2]));
        if (!together || n.isZero(0)) continue;
        ++parted;
        for (int i = 0; i < first; ++i) m.x[i] += 0x1p-36 * n;
        if (origin.cwiseAbs().maxCoeff() < 1e3) CHECK(!exactly_touch(kind, m));
    }
    CHECK(parted > 2500);
}
