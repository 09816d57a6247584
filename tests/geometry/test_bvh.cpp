// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/bvh.h"
#include "geometry/parallel.h"
#include "tests/support/random.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>

using namespace toile;

namespace {

using Pairs = std::vector<std::array<int, 2>>;

std::vector<Box> random_boxes(test::Random& random, int n, double size, int kind) {
    std::vector<Box> boxes;
    for (int i = 0; i < n; ++i) {
        Vec3 p = random.vec3();
        if (kind == 1) p[1] = p[2] = 0;                              // on a line
        if (kind == 2) p = Vec3::Ones();                             // all in one place
        if (kind == 3) p = Vec3::Ones() * std::pow(2.0, -(i % 900)); // crowded toward a point
        if (kind == 4) p = (p * 4).array().round();                  // many equal
        const Vec3 half = (random.vec3(size)).cwiseAbs();
        boxes.push_back(kind == 5 && i % 3 == 0 ? Box() : Box(p - half, p + half));
    }
    return boxes;
}

bool meet(const Box& a, const Box& b) {
    return !a.isEmpty() && !b.isEmpty() && a.intersects(b);
}

} // namespace

TEST_CASE("box and tree queries find what comparing everything finds") {
    test::Random random(5);
    for (int kind = 0; kind < 6; ++kind)
        for (int n : {0, 1, 4, 5, 300}) {
            const auto a = random_boxes(random, n, 0.1, kind), b = random_boxes(random, n / 2, 0.2, kind);
            const Bvh tree_a(a), tree_b(b);
            INFO("kind " << kind << ", " << n << " boxes");
            CHECK(tree_a.size() == n);
            Pairs fast, slow, fast_self, slow_self;
            tree_a.overlapping(tree_b, [&](int i, int j) { fast.push_back({i, j}); });
            tree_a.overlapping_pairs([&](int i, int j) { fast_self.push_back({i, j}); });
            for (int i = 0; i < n; ++i) {
                for (int j = 0; j < int(b.size()); ++j)
                    if (meet(a[i], b[j])) slow.push_back({i, j});
                for (int j = i + 1; j < n; ++j)
                    if (meet(a[i], a[j])) slow_self.push_back({i, j});
            }
            std::sort(fast.begin(), fast.end());
            std::sort(fast_self.begin(), fast_self.end());
            CHECK(fast == slow);
            CHECK(fast_self == slow_self);
            for (const Box& query : random_boxes(random, 20, 0.3, 0)) {
                std::vector<int> found, expected;
                tree_a.overlapping(query, [&](int i) { found.push_back(i); });
                for (int i = 0; i < n; ++i)
                    if (meet(a[i], query)) expected.push_back(i);
                std::sort(found.begin(), found.end());
                CHECK(found == expected);
            }
        }
}

TEST_CASE("nearest finds the lowest of the nearest items within the limit") {
    test::Random random(6);
    for (int kind : {0, 1, 2, 3, 4}) {
        const auto boxes = random_boxes(random, 257, 0, kind);
        const Bvh tree(boxes);
        for (int k = 0; k < 200; ++k) {
            const Vec3 p = kind == 4 ? Vec3((random.vec3() * 8).array().round() / 2) : random.vec3(1.5);
            const auto distance = [&](int i) { return (boxes[i].min() - p).squaredNorm(); };
            int slow = 0;
            for (int i = 1; i < 257; ++i)
                if (distance(i) < distance(slow)) slow = i;
            double limit = std::numeric_limits<double>::infinity();
            CHECK(tree.nearest(p, limit, distance) == slow);
            CHECK(limit == distance(slow));
            limit = distance(slow); // exactly on the limit still counts
            CHECK(tree.nearest(p, limit, distance) == slow);
            limit = std::nextafter(distance(slow), -1.0);
            CHECK(tree.nearest(p, limit, distance) == -1);
        }
    }
    double limit = 1;
    CHECK(Bvh().nearest(Vec3(0, 0, 0), limit, [](int) { return 0.0; }) == -1);
}

TEST_CASE("a refitted tree answers like one built anew, and other numbers of boxes are refused") {
    test::Random random(7);
    Bvh tree(random_boxes(random, 200, 0.1, 0));
    const auto moved = random_boxes(random, 200, 0.1, 0);
    tree.refit(moved);
    const Bvh fresh(moved);
    Pairs refitted, built;
    tree.overlapping_pairs([&](int i, int j) { refitted.push_back({i, j}); });
    fresh.overlapping_pairs([&](int i, int j) { built.push_back({i, j}); });
    std::sort(refitted.begin(), refitted.end());
    std::sort(built.begin(), built.end());
    REQUIRE(!built.empty());
    CHECK(refitted == built);
    CHECK_THROWS_AS(tree.refit({}), std::invalid_argument);
}

TEST_CASE("boxes of points, edges and triangles hold their corners with the margin") {
    const Points p = {{0, 0, 0}, {1, 2, 3}, {-1, 5, 1}};
    const Box t = triangle_boxes(p, {{0, 1, 2}}, 0.5)[0];
    CHECK(t.min() == Vec3(-1.5, -0.5, -0.5));
    CHECK(t.max() == Vec3(1.5, 5.5, 3.5));
    const Box e = edge_boxes(p, {{1, 2}}, 0)[0];
    CHECK(e.min() == Vec3(-1, 2, 1));
    CHECK(e.max() == Vec3(1, 5, 3));
    CHECK(point_boxes(p, 1)[1].min() == Vec3(0, 1, 2));
}
