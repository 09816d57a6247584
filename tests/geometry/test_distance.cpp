// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/distance.h"
#include "tests/support/random.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace toile;

namespace {

using Points4 = std::array<Vec3, 4>;

// Squared distance of two convex sets spanned by points, by projected gradient on the barycentric weights
// (Frank-Wolfe with exact line search along pairs of corners): slow, obvious, blind to special cases.
double slow_squared(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    std::vector<double> wa(a.size(), 1.0 / a.size()), wb(b.size(), 1.0 / b.size());
    const auto gap = [&] {
        Vec3 g = Vec3::Zero();
        for (std::size_t i = 0; i < a.size(); ++i)
            g -= wa[i] * a[i];
        for (std::size_t i = 0; i < b.size(); ++i)
            g += wb[i] * b[i];
        return g;
    };
    const auto relax = [&](const std::vector<Vec3>& p, std::vector<double>& w, double sign) {
        for (std::size_t i = 0; i < p.size(); ++i)
            for (std::size_t j = i + 1; j < p.size(); ++j) {
                const Vec3 d = sign * (p[j] - p[i]); // moving weight from i to j moves the gap along d
                if (d.squaredNorm() == 0) continue;
                const double m = std::clamp(-gap().dot(d) / d.squaredNorm(), -w[j], w[i]);
                w[i] -= m;
                w[j] += m;
            }
    };
    double last = gap().squaredNorm();
    for (int k = 0; k < 20000; ++k) {
        relax(a, wa, -1);
        relax(b, wb, +1);
        const double now = gap().squaredNorm();
        if (k % 50 == 49) {
            if (last - now <= 1e-15 * now) break;
            last = now;
        }
    }
    return gap().squaredNorm();
}

void check_consistent(const Nearest& n, const Vec3& gap, int first_size) {
    double first = 0, second = 0;
    for (int k = 0; k < 4; ++k) {
        CHECK(n.weight[k] >= 0);
        if (!(n.active >> k & 1)) CHECK(n.weight[k] == 0);
        if (n.active >> k & 1) CHECK(n.weight[k] > 0);
        (k < first_size ? first : second) += n.weight[k];
    }
    CHECK(first == Approx(1).epsilon(1e-14));
    CHECK(second == Approx(1).epsilon(1e-14));
    CHECK(gap.norm() == Approx(std::sqrt(n.squared)).epsilon(1e-9).margin(1e-15));
}

Nearest checked_point_triangle(const Points4& x) {
    const Nearest n = nearest_point_triangle(x[0], x[1], x[2], x[3]);
    check_consistent(n, gap_point_triangle(n, x), 1);
    return n;
}

Nearest checked_edge_edge(const Points4& x) {
    const Nearest n = nearest_edge_edge(x[0], x[1], x[2], x[3]);
    check_consistent(n, gap_edge_edge(n, x), 2);
    return n;
}

// Random points made degenerate in various ways.
Points4 awkward(test::Random& random, int kind) {
    Points4 x;
    for (Vec3& p : x)
        p = random.vec3();
    switch (kind % 8) {
    case 1:
        x[3] = x[2];
        break; // a side of no length
    case 2:
        x[3] = x[2] = x[1];
        break; // a point
    case 3:
        x[3] = x[1] + random.in(-1, 2) * (x[2] - x[1]);
        break; // three on a line
    case 4:
        x[3] = x[2] + (x[1] - x[0]) * random.in(-2, 2);
        break; // parallel edges
    case 5:
        x[3] = x[2] + (x[1] - x[0]) + random.vec3(1e-8);
        break; // nearly parallel edges
    case 6:
        for (Vec3& p : x)
            p[2] = 0;
        break; // all in one plane
    case 7:
        x[3] = 0.5 * (x[1] + x[2]) + random.vec3(1e-9);
        break; // a sliver
    default:
        break;
    }
    return x;
}

} // namespace

TEST_CASE("point-triangle distance is the one that minimisation finds") {
    test::Random random(2);
    std::array<int, 16> seen{};
    for (int k = 0; k < 800; ++k) {
        const Points4 x = awkward(random, k);
        const Nearest n = checked_point_triangle(x);
        ++seen[n.active];
        INFO("case " << k);
        // Below both: where the triangle is flat the minimisation is the less exact of the two.
        CHECK(std::sqrt(n.squared) <= std::sqrt(slow_squared({x[0]}, {x[1], x[2], x[3]})) + 1e-8);
        CHECK(std::sqrt(n.squared) >= std::sqrt(slow_squared({x[0]}, {x[1], x[2], x[3]})) - 1e-4);
    }
    for (int active : {0b0011, 0b0101, 0b1001, 0b0111, 0b1101, 0b1011, 0b1111})
        CHECK(seen[active] > 0);
}

TEST_CASE("edge-edge distance is the one that minimisation finds") {
    test::Random random(3);
    std::array<int, 16> seen{};
    for (int k = 0; k < 800; ++k) {
        const Points4 x = awkward(random, k);
        const Nearest n = checked_edge_edge(x);
        ++seen[n.active];
        INFO("case " << k);
        CHECK(std::sqrt(n.squared) <= std::sqrt(slow_squared({x[0], x[1]}, {x[2], x[3]})) + 1e-8);
        CHECK(std::sqrt(n.squared) >= std::sqrt(slow_squared({x[0], x[1]}, {x[2], x[3]})) - 1e-4);
    }
    for (int active : {0b0101, 0b0110, 0b1001, 0b1010, 0b0111, 0b1011, 0b1101, 0b1110, 0b1111})
        CHECK(seen[active] > 0);
}

TEST_CASE("no sampled pair of points is nearer than the nearest") {
    test::Random random(4);
    for (int k = 0; k < 400; ++k) {
        const Points4 x = awkward(random, k);
        const double pt = nearest_point_triangle(x[0], x[1], x[2], x[3]).squared;
        const double ee = nearest_edge_edge(x[0], x[1], x[2], x[3]).squared;
        for (int i = 0; i <= 20; ++i)
            for (int j = 0; j <= 20; ++j) {
                const double s = i / 20.0, t = j / 20.0;
                const Vec3 on_a = x[0] + s * (x[1] - x[0]), on_b = x[2] + t * (x[3] - x[2]);
                CHECK((on_a - on_b).squaredNorm() >= ee * (1 - 1e-9) - 1e-18);
                const Vec3 on_face = x[1] + s * (x[2] - x[1]) + (1 - s) * t * (x[3] - x[1]);
                CHECK((on_face - x[0]).squaredNorm() >= pt * (1 - 1e-9) - 1e-18);
            }
    }
}

TEST_CASE("a gap of a micrometre two metres from the origin keeps its digits") {
    const Vec3 o(1.5, 1.75, -2); // binary fractions: the offsets below are exact
    const double gap = 0x1p-20;
    const Vec3 a = o, b = o + Vec3(0x1p-7, 0, 0), c = o + Vec3(0, 0x1p-7, 0);
    const Vec3 p = o + Vec3(0x1p-9, 0x1p-9, gap);
    CHECK(std::sqrt(nearest_point_triangle(p, a, b, c).squared) == Approx(gap).epsilon(1e-12));
    const Vec3 e0 = o + Vec3(0x1p-9, -0x1p-8, gap), e1 = o + Vec3(0x1p-9, 0x1p-8, gap);
    CHECK(std::sqrt(nearest_edge_edge(a, b, e0, e1).squared) == Approx(gap).epsilon(1e-12));
}

TEST_CASE("features are named") {
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
    CHECK(nearest_point_triangle({0.25, 0.25, 1}, a, b, c).active == 0b1111);
    CHECK(nearest_point_triangle({0.5, -1, 1}, a, b, c).active == 0b0111);
    CHECK(nearest_point_triangle({1, 1, 1}, a, b, c).active == 0b1101);
    CHECK(nearest_point_triangle({-1, 0.5, 0}, a, b, c).active == 0b1011);
    CHECK(nearest_point_triangle({-1, -1, 0}, a, b, c).active == 0b0011);
    CHECK(nearest_point_triangle({2, 0, 0}, a, b, c).active == 0b0101);
    CHECK(nearest_point_triangle({0, 2, 0}, a, b, c).active == 0b1001);
    // On the edge and on the corner: the smaller feature.
    CHECK(nearest_point_triangle({0.5, 0, 1}, a, b, c).active == 0b0111);
    CHECK(nearest_point_triangle({1, 0, 1}, a, b, c).active == 0b0101);

    CHECK(nearest_edge_edge(a, b, {0.5, -1, 1}, {0.5, 1, 1}).active == 0b1111);
    CHECK(nearest_edge_edge(a, b, {0.5, 1, 1}, {0.5, 2, 1}).active == 0b0111);
    CHECK(nearest_edge_edge(a, b, {2, 1, 0}, {3, 1, 0}).active == 0b0110);
    CHECK(nearest_edge_edge(a, b, {-1, -1, 0}, {-1, 1, 0}).active == 0b1101);
}

TEST_CASE("nearest on a segment") {
    CHECK(nearest_on_segment({0.25, 3, 0}, {0, 0, 0}, {1, 0, 0}) == 0.25);
    CHECK(nearest_on_segment({-1, 3, 0}, {0, 0, 0}, {1, 0, 0}) == 0);
    CHECK(nearest_on_segment({5, 3, 0}, {0, 0, 0}, {1, 0, 0}) == 1);
    CHECK(nearest_on_segment({5, 3, 0}, {1, 1, 1}, {1, 1, 1}) == 0);
}
