// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/self_touch.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace toile;

namespace {

bool may_touch(const TriMesh& m, double reach) { return may_touch_itself(m.triangles, m.points, reach); }

/// A sheet of 40 x 20 cm bent round the z axis by `turn` rad in all, at equal distances.
TriMesh bent(double turn) {
    TriMesh m = test::grid(20, 10, 0.02);
    for (Vec3& p : m.points) {
        const double r = 0.4 / turn, a = p.x() / r;
        p = {r * std::sin(a), r * (1 - std::cos(a)), p.y()};
    }
    return m;
}

} // namespace

TEST_CASE("a flat sheet and a tube cannot touch themselves while they keep their distance") {
    CHECK_FALSE(may_touch(test::grid(10, 10, 0.02), 0.1));
    const TriMesh tube = test::tube(0.16, 0.5, 36, 12);
    CHECK_FALSE(may_touch(tube, 0.01));
    CHECK(may_touch(tube, 0.4)); // across
}

TEST_CASE("ends of a sheet that are bent toward each other may touch within their distance") {
    const TriMesh open = bent(5.8); // the ends are 3.3 cm apart
    CHECK_FALSE(may_touch(open, 0.02));
    CHECK(may_touch(open, 0.04));
}

TEST_CASE("a fold may touch itself however far its sides are apart") {
    TriMesh m = test::grid(10, 10, 0.02);
    for (Vec3& p : m.points)
        if (p.x() > 0.1) p = {0.1 - std::cos(0.9) * (p.x() - 0.1), p.y(), std::sin(0.9) * (p.x() - 0.1)}; // by 128 degrees
    CHECK(may_touch(m, 1e-4));
}

TEST_CASE("what cannot be told may touch") {
    TriMesh m = test::grid(2, 2, 0.02);
    m.points[1] = m.points[0]; // triangles of no area
    CHECK(may_touch(m, 1e-4));
    TriMesh two = test::grid(3, 3, 0.02);
    const TriMesh above = test::grid(3, 3, 0.02, 0.01);
    const int n = int(two.points.size());
    two.points.insert(two.points.end(), above.points.begin(), above.points.end());
    for (const Triangle& t : above.triangles) two.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
    CHECK(may_touch(two, 0.011));
    CHECK_FALSE(may_touch(two, 0.009));
}
