// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/edges.h"
#include "tests/support/random.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <map>

using namespace toile;

namespace {

// What make_edges must say, by a map.
std::map<std::array<int, 2>, std::vector<int>> slow_edges(const std::vector<Triangle>& triangles) {
    std::map<std::array<int, 2>, std::vector<int>> edges;
    for (int t = 0; t < int(triangles.size()); ++t)
        for (int k = 0; k < 3; ++k) {
            const int a = triangles[t][(k + 1) % 3], b = triangles[t][(k + 2) % 3];
            edges[{std::min(a, b), std::max(a, b)}].push_back(t);
        }
    return edges;
}

} // namespace

TEST_CASE("edges of two triangles") {
    const std::vector<Triangle> triangles = {{0, 1, 2}, {2, 1, 3}};
    const EdgeTable e = make_edges(triangles, 4);
    REQUIRE(e.ends == std::vector<std::array<int, 2>>{{0, 1}, {0, 2}, {1, 2}, {1, 3}, {2, 3}});
    CHECK(e.triangles_at(2) == 2);
    CHECK(e.triangles_at(0) == 1);
    CHECK(e.of_triangle[0] == std::array<int, 3>{2, 1, 0});
    CHECK(e.of_triangle[1] == std::array<int, 3>{3, 4, 2});
}

TEST_CASE("edge table equals a map of edges on random triangles, three and more to an edge included") {
    test::Random random(1);
    for (int round = 0; round < 20; ++round) {
        const int points = 4 + random.below(20);
        std::vector<Triangle> triangles;
        while (triangles.size() < 60) {
            const Triangle t{random.below(points), random.below(points), random.below(points)};
            if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
        }
        const EdgeTable e = make_edges(triangles, points);
        const auto slow = slow_edges(triangles);
        REQUIRE(e.size() == int(slow.size()));
        REQUIRE(e.first.back() == int(3 * triangles.size()));
        int k = 0;
        for (const auto& [ends, incident] : slow) {
            REQUIRE(e.ends[k] == ends);
            REQUIRE(std::vector<int>(e.incident.begin() + e.first[k], e.incident.begin() + e.first[k + 1]) ==
                    incident);
            ++k;
        }
        for (int t = 0; t < int(triangles.size()); ++t)
            for (int c = 0; c < 3; ++c) {
                auto ends = e.ends[e.of_triangle[t][c]];
                CHECK(std::find(ends.begin(), ends.end(), triangles[t][c]) == ends.end());
                for (int end : ends)
                    CHECK(std::count(triangles[t].begin(), triangles[t].end(), end) == 1);
            }
    }
}

TEST_CASE("edge table of nothing, and of triangles that cannot be") {
    CHECK(make_edges({}, 0).size() == 0);
    CHECK(make_edges({}, 0).first == std::vector<int>{0});
    CHECK_THROWS_WITH(make_edges({{0, 1, 3}}, 3), Catch::Contains("triangle 0 names point 3"));
    CHECK_THROWS_WITH(make_edges({{0, 1, 2}, {1, 2, 1}}, 3),
                      Catch::Contains("triangle 1 names a point twice"));
}

TEST_CASE("pieces are counted over shared points, stray points are none") {
    CHECK(count_pieces({}, 5) == 0);
    CHECK(count_pieces({{0, 1, 2}, {2, 3, 4}}, 9) == 1);
    CHECK(count_pieces({{0, 1, 2}, {5, 3, 4}, {6, 7, 8}, {8, 3, 6}}, 9) == 2);
    CHECK(pieces({{4, 1, 2}}, 5) == std::vector<int>{0, 1, 1, 3, 1});
}
