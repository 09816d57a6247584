// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/crossing.h"
#include "tests/support/polygon.h"

#include <catch2/catch.hpp>

#include <random>
#include <set>

using namespace toile;
using test::polygon;

namespace {

bool left_of(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x()) > 0;
}

bool cross(const Edge& s, const Edge& t) {
    return left_of(s.start, s.end, t.start) != left_of(s.start, s.end, t.end) &&
           left_of(t.start, t.end, s.start) != left_of(t.start, t.end, s.end);
}

} // namespace

TEST_CASE("crossings are those of the slow test of all pairs") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> at(0, 1);
    int crossing = 0;
    for (int trial = 0; trial < 200; ++trial) {
        std::vector<Vec2> points;
        for (int i = 0; i < 4 + trial % 4; ++i)
            points.push_back({at(random), at(random)});
        const Loop loop = polygon(points);
        const int n = int(loop.size());
        std::set<std::pair<int, int>> slow, fast;
        for (int i = 0; i < n; ++i)
            for (int j = i + 2; j < n; ++j)
                if (!(i == 0 && j == n - 1) && cross(loop[i], loop[j])) slow.insert({i, j});
        for (const LineCrossing& c : find_crossings({{&loop, true, false}}, 20)) {
            CHECK_FALSE(c.touch);
            fast.insert({c.edge_a, c.edge_b});
        }
        CHECK(fast == slow);
        crossing += !slow.empty();
    }
    CHECK(crossing > 50);
    CHECK(crossing < 190);
}

TEST_CASE("the pairs do not depend on where the loop starts") {
    const std::vector<Vec2> points{{0, 0}, {0.3, 0.3}, {0.3, 0}, {0.1, 0.25}, {0, 0.2}};
    for (int shift = 0; shift < 5; ++shift) {
        std::vector<Vec2> turned;
        for (int i = 0; i < 5; ++i)
            turned.push_back(points[(i + shift) % 5]);
        const Loop loop = polygon(turned);
        const auto found = find_crossings({{&loop, true, false}}, 20);
        REQUIRE(found.size() == 1);
        const std::set<int> edges{(found[0].edge_a + shift) % 5, (found[0].edge_b + shift) % 5};
        CHECK(edges == std::set<int>{0, 2});
    }
}

TEST_CASE("a point is inside a loop with its curves") {
    Loop loop = polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
    CHECK(contains(loop, {0.5, 0.1}));
    CHECK_FALSE(contains(loop, {0.5, -0.1}));
    loop[0].curve = Quadratic{{0.5, -0.4}};
    CHECK(contains(loop, {0.5, -0.1}));
    CHECK_FALSE(contains(loop, {0.02, -0.1}));
}
