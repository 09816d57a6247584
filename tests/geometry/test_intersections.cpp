// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/intersections.h"
#include "tests/support/random.h"
#include "tests/support/surfaces.h"
#include "tests/support/test_data.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>

using namespace toile;

namespace {

using Pairs = std::vector<std::array<int, 2>>;

const TriMesh base = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};

bool cuts_base(const Vec3& a, const Vec3& b, const Vec3& c) {
    const TriMesh other = {{a, b, c}, {{0, 1, 2}}};
    const bool ab = !intersecting_pairs(base, other).empty(), ba = !intersecting_pairs(other, base).empty();
    CHECK(ab == ba);
    // The same two triangles as one mesh without shared points.
    TriMesh both = base;
    both.points.insert(both.points.end(), other.points.begin(), other.points.end());
    both.triangles.push_back({3, 4, 5});
    CHECK(!self_intersecting_pairs(both).empty() == ab);
    return ab;
}

// Two triangles over four or five points, corners shared by index.
bool cuts_itself(const Points& points, const Triangle& s, const Triangle& t) {
    bool first = true, result = false;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) { // every rotation says the same
            const Triangle a = {s[i], s[(i + 1) % 3], s[(i + 2) % 3]},
                           b = {t[j], t[(j + 1) % 3], t[(j + 2) % 3]};
            const bool cuts = !self_intersecting_pairs({points, {a, b}}).empty();
            CHECK(cuts == !self_intersecting_pairs({points, {{b[1], b[0], b[2]}, a}}).empty());
            if (first) result = cuts;
            CHECK(cuts == result);
            first = false;
        }
    return result;
}

} // namespace

TEST_CASE("triangles that share no point") {
    CHECK(cuts_base({.2, .2, -1}, {.2, .2, 1}, {.3, .8, 1}));       // through the inside
    CHECK_FALSE(cuts_base({.2, .2, 1e-300}, {1, 0, 1}, {0, 1, 1})); // above by the least bit
    CHECK(cuts_base({.2, .2, 0}, {1, 0, 1}, {0, 1, 1}));            // a corner touches the inside
    CHECK(cuts_base({0, 0, 0}, {-1, 0, 0}, {0, -1, 0}));            // corner on corner, same plane
    CHECK(cuts_base({.5, -1, 0}, {.5, 0, 0}, {1, -1, 0}));          // corner on side, same plane
    CHECK(cuts_base({.1, .1, 0}, {.2, .1, 0}, {.1, .2, 0}));        // inside, same plane
    CHECK(cuts_base({.1, .1, 0}, {2, .1, 0}, {.1, 2, 0}));          // overlap, same plane
    CHECK(cuts_base({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));              // the same triangle
    CHECK_FALSE(cuts_base({1, 1, 0}, {2, 1, 0}, {1, 2, 0}));        // beside, same plane
    CHECK(cuts_base({.5, -1, -1}, {.5, 1, 1}, {.5, -1, 1}));        // side against side
    CHECK_FALSE(cuts_base({0, 0, 1}, {1, 0, 1}, {0, 1, 1}));        // parallel
    CHECK(cuts_base({-1, 0, 0}, {2, 0, 0}, {0, 0, 1}));             // a side lies along a side
}

TEST_CASE("triangles that are a segment or a point count as such") {
    CHECK(cuts_base({.2, .2, -1}, {.2, .2, 1}, {.2, .2, .5}));
    CHECK_FALSE(cuts_base({.2, .2, .1}, {.2, .2, 1}, {.2, .2, .5}));
    CHECK(cuts_base({.2, .2, 0}, {.2, .2, 0}, {.2, .2, 0}));
    CHECK_FALSE(cuts_base({.2, .2, 1}, {.2, .2, 1}, {.2, .2, 1}));
    const TriMesh a = {{{0, 0, 0}, {1, 0, 0}, {.5, 0, 0}}, {{0, 1, 2}}}; // segment
    const TriMesh b = {{{.5, -1, 0}, {.5, 1, 0}, {.5, 0, 0}}, {{0, 1, 2}}};
    const TriMesh c = {{{.5, 0, 0}, {.5, 0, 0}, {.5, 0, 0}}, {{0, 1, 2}}}; // point
    CHECK(intersecting_pairs(a, b).size() == 1);
    CHECK(intersecting_pairs(a, c).size() == 1);
    CHECK(intersecting_pairs(c, c).size() == 1);
}

TEST_CASE("neighbours over an edge intersect only when folded flat onto each other") {
    const auto folded = [](const Vec3& tip) {
        return cuts_itself({{0, 0, 0}, {1, 0, 0}, {.3, 1, 0}, tip}, {0, 1, 2}, {1, 0, 3});
    };
    CHECK_FALSE(folded({.3, -1, 0}));     // flat
    CHECK_FALSE(folded({.3, 0, 1}));      // at a right angle
    CHECK_FALSE(folded({.3, 1, 1e-300})); // all but closed
    CHECK(folded({.3, 1, 0}));            // closed exactly
    CHECK(folded({.9, .1, 0}));           // closed, another shape
    CHECK(folded({5, .1, 0}));            // closed, the tip outside
    CHECK_FALSE(folded({.5, 0, 0}));      // a neighbour of no area
    CHECK_FALSE(folded({2, 0, 0}));       // a neighbour of no area beyond the edge's end
}

TEST_CASE("neighbours at a point are tested for what lies beyond it") {
    const auto cuts = [](const Vec3& c, const Vec3& d) {
        return cuts_itself({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, c, d}, {0, 1, 2}, {0, 3, 4});
    };
    CHECK_FALSE(cuts({-1, 0, 0}, {0, -1, 0})); // opposite, same plane
    CHECK_FALSE(cuts({1, 0, 1}, {0, 1, 1}));   // leaves upward
    CHECK_FALSE(cuts({0, 0, 1}, {-1, -1, 1}));
    CHECK(cuts({1, 1, -1}, {1, 1, 1}));             // cuts through, across the far side
    CHECK(cuts({.2, .2, -.1}, {.2, .2, .1}));       // cuts through, its far side within
    CHECK(cuts({.2, .3, 0}, {0, 0, 1}));            // an edge of it lies in the other
    CHECK(cuts({1, 0, 0}, {0, 0, 1}));              // edge lies on edge, index not shared
    CHECK(cuts({2, 0, 0}, {2, -1, 0}));             // edge lies along edge, same plane
    CHECK(cuts({.5, .1, 0}, {.1, .5, 0}));          // within, same plane
    CHECK(cuts({3, 1, 0}, {1, 3, 0}));              // overlaps, same plane
    CHECK_FALSE(cuts({1, -1e-300, 0}, {0, -1, 0})); // beside by the least bit, same plane
}

TEST_CASE("a triangle given twice intersects itself") {
    CHECK(self_intersecting_pairs({base.points, {{0, 1, 2}, {0, 1, 2}}}).size() == 1);
    CHECK(self_intersecting_pairs({base.points, {{0, 1, 2}, {2, 1, 0}}}).size() == 1);
}

TEST_CASE("pairs found among many are those found one by one") {
    test::Random random(10);
    TriMesh a, b;
    for (TriMesh* m : {&a, &b})
        for (int t = 0; t < 120; ++t) {
            const Vec3 centre = random.vec3(), grain = Vec3::Constant(8);
            for (int k = 0; k < 3; ++k) // on a coarse raster: many touch, share corners and planes
                m->points.push_back(((centre + random.vec3(0.3)).cwiseProduct(grain)).array().round());
            m->triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
        }
    Pairs slow, slow_self;
    for (int i = 0; i < 120; ++i)
        for (int j = 0; j < 120; ++j) {
            if (!intersecting_pairs({a.points, {a.triangles[i]}}, {b.points, {b.triangles[j]}}).empty())
                slow.push_back({i, j});
            if (i < j && !self_intersecting_pairs({a.points, {a.triangles[i], a.triangles[j]}}).empty())
                slow_self.push_back({i, j});
        }
    CHECK(slow.size() > 50);
    CHECK(intersecting_pairs(a, b) == slow);
    CHECK(self_intersecting_pairs(a) == slow_self);
}

TEST_CASE("clean surfaces are clean, and a pushed-in tube is not") {
    const TriMesh body = test::ellipsoid({0.2, 0.6, 0.2}, 40, 40);
    TriMesh tube = test::tube(0.21, 0.4, 40, 20);
    CHECK(self_intersecting_pairs(body).empty());
    CHECK(self_intersecting_pairs(tube).empty());
    CHECK(intersecting_pairs(tube, body).empty());
    for (Vec3& p : tube.points)
        p[0] += 0.05;
    CHECK(!intersecting_pairs(tube, body).empty());
    CHECK(intersecting_pairs(body, tube).size() == intersecting_pairs(tube, body).size());
}

TEST_CASE("coordinates that are no numbers are refused") {
    TriMesh broken = base;
    broken.points[1][2] = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH(intersecting_pairs(base, broken), Catch::Contains("point 1 is not finite"));
    CHECK_THROWS_AS(self_intersecting_pairs(broken), std::invalid_argument);
}
