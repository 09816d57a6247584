// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/curve.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace toile;

namespace {

double cross(const Vec2& a, const Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}

std::vector<Edge> samples() {
    const Vec2 a(0.1, -0.2), b(0.5, 0.1);
    return {{a, b, Straight{}, {}},
            {a, b, Quadratic{{0.4, -0.4}}, {}},
            {a, b, Quadratic{{0.9, 0.5}}, {}}, // turns back sharply
            {a, b, Cubic{{0.0, 0.3}, {0.6, -0.5}}, {}},
            {a, b, Cubic{{0.9, 0.3}, {-0.3, 0.1}}, {}}, // nearly a loop
            {a, b, Cubic{a, b}, {}},                    // stands still at both ends
            {a, b, Arc{0.26, false, false}, {}},
            {a, b, Arc{0.26, false, true}, {}},
            {a, b, Arc{0.3, true, false}, {}},
            {a, b, Arc{0.3, true, true}, {}},
            {a, b, Arc{1e7, false, true}, {}}};
}

double polyline_length(const std::vector<Vec2>& p) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < p.size(); ++i)
        sum += (p[i + 1] - p[i]).norm();
    return sum;
}

/// Area of the closed polyline through many points at equal parameters: the obvious twin of signed_area.
double polygon_area(const Loop& loop, int n) {
    double twice = 0;
    for (const Edge& e : loop)
        for (int i = 0; i < n; ++i)
            twice += cross(point_at(e, double(i) / n), point_at(e, double(i + 1) / n));
    return 0.5 * twice;
}

} // namespace

TEST_CASE("the length of a curve is that of its finest polyline") {
    for (const Edge& e : samples()) {
        std::vector<Vec2> fine;
        const int n = 20000;
        for (int i = 0; i <= n; ++i)
            fine.push_back(point_at(e, double(i) / n));
        CHECK(length(e) == Approx(polyline_length(fine)).epsilon(1e-7));
    }
}

TEST_CASE("lengths known in closed form are met to twelve digits") {
    // A parabola over [-1, 1] with its control point at height 2h.
    const double h = 0.7, q = std::sqrt(1 + 4 * h * h);
    const Edge parabola{{-1, 0}, {1, 0}, Quadratic{{0, 2 * h}}, {}};
    CHECK(length(parabola) == Approx(q + std::asinh(2 * h) / (2 * h)).epsilon(1e-12));

    // Semicubical parabola (t^2, t^3), t in [0, 1]: a cusp at the start.
    const Edge cusp{{0, 0}, {1, 1}, Cubic{{0, 0}, {1.0 / 3, 0}}, {}};
    CHECK(length(cusp) == Approx((13 * std::sqrt(13.0) - 8) / 27).epsilon(1e-12));

    const Edge half{{1, 0}, {-1, 0}, Arc{1, false, true}, {}};
    CHECK(length(half) == Approx(EIGEN_PI).epsilon(1e-14));
    const Edge most{{1, 0}, {0, 1}, Arc{1, true, false}, {}};
    CHECK(length(most) == Approx(1.5 * EIGEN_PI).epsilon(1e-14));
    const Edge flat{{0, 0}, {1, 0}, Arc{1e9, false, true}, {}};
    CHECK(length(flat) == Approx(1).epsilon(1e-14));
}

TEST_CASE("an arc bulges to the side it says and keeps its radius") {
    for (bool large : {false, true})
        for (bool right : {false, true}) {
            const Edge e{{0, 0}, {1, 0}, Arc{0.8, large, right}, {}};
            const Vec2 middle = point_at(e, 0.5);
            const double rise = 0.8 + (large ? 1 : -1) * std::sqrt(0.64 - 0.25);
            CHECK(middle.x() == Approx(0.5));
            CHECK(middle.y() == Approx(right ? -rise : rise));
            const Vec2 centre = middle + Vec2(0, right ? 0.8 : -0.8);
            for (double u : {0.0, 0.1, 0.37, 0.9, 1.0})
                CHECK((point_at(e, u) - centre).norm() == Approx(0.8).epsilon(1e-13));
        }
}

TEST_CASE("control points bulge a curve to their side") {
    const Edge left{{0, 0}, {1, 0}, Quadratic{{0.5, 0.2}}, {}};
    CHECK(point_at(left, 0.5).y() == Approx(0.1));
    const Edge cubic{{0, 0}, {1, 0}, Cubic{{0.2, -0.4}, {0.8, -0.4}}, {}};
    CHECK(point_at(cubic, 0.5).y() == Approx(-0.3));
}

TEST_CASE("samples are equally far along the curve and end exactly") {
    for (const Edge& e : samples()) {
        const int n = 7;
        const std::vector<Vec2> p = sample(e, 0, 1, n);
        REQUIRE(p.size() == std::size_t(n + 1));
        CHECK(p.front() == e.start);
        CHECK(p.back() == e.end);
        const int fine = 400;
        const std::vector<Vec2> all = sample(e, 0, 1, n * fine);
        const double total = length(e);
        for (int i = 0; i < n; ++i) {
            CHECK((all[i * fine] - p[i]).norm() < 1e-12);
            const std::vector<Vec2> piece(all.begin() + i * fine, all.begin() + (i + 1) * fine + 1);
            CHECK(polyline_length(piece) == Approx(total / n).epsilon(4e-4));
        }
    }
}

TEST_CASE("a part of an edge is sampled from either end") {
    for (const Edge& e : samples()) {
        const std::vector<Vec2> there = sample(e, 0.2, 0.7, 5), back = sample(e, 0.7, 0.2, 5);
        for (int i = 0; i <= 5; ++i)
            CHECK((there[i] - back[5 - i]).norm() < 1e-12);
        CHECK(sample(e, 1, 0, 3).front() == e.end);
        CHECK(sample(e, 1, 0, 3).back() == e.start);
        CHECK((sample(e, 0, 1, 10)[2] - there[0]).norm() < 1e-10);
    }
}

TEST_CASE("the other way round an edge is the same curve") {
    for (const Edge& e : samples()) {
        const Edge r = reversed(e);
        for (double u : {0.0, 0.2, 0.5, 0.9, 1.0})
            CHECK((point_at(e, u) - point_at(r, 1 - u)).norm() < 1e-8); // a radius of 1e7 m costs digits
        CHECK(length(r) == Approx(length(e)).epsilon(1e-12));
    }
}

TEST_CASE("the tangent is the direction of travel, at standstills too") {
    for (const Edge& e : samples())
        for (double u : {0.0, 0.3, 0.8, 1.0}) {
            const double h = 1e-5, u0 = std::max(0.0, u - h), u1 = std::min(1.0, u + h);
            const Vec2 way = (point_at(e, u1) - point_at(e, u0)).normalized();
            CHECK((tangent_at(e, u) - way).norm() < 1e-3);
        }
}

TEST_CASE("the polyline with the intervals asked for stays within its tolerance") {
    for (const Edge& e : samples())
        for (double tolerance : {1e-3, 1e-5}) {
            const int n = intervals_for_sag(e, tolerance);
            const std::vector<Vec2> p = sample(e, 0, 1, n), fine = sample(e, 0, 1, 50 * n);
            double worst = 0;
            for (int i = 0; i < n; ++i)
                for (int k = 0; k <= 50; ++k) {
                    const Vec2 d = p[i + 1] - p[i], x = fine[50 * i + k] - p[i];
                    const double t = std::min(1.0, std::max(0.0, x.dot(d) / d.squaredNorm()));
                    worst = std::max(worst, (x - t * d).norm());
                }
            CHECK(worst <= 1.05 * tolerance);
            if (n > 4) CHECK(worst > 0.1 * tolerance); // not far finer than asked for
        }
}

TEST_CASE("the area of a loop counts its curves") {
    const Loop disc{{{1, 0}, {-1, 0}, Arc{1, false, true}, {}}, {{-1, 0}, {1, 0}, Arc{1, false, true}, {}}};
    CHECK(signed_area(disc) == Approx(EIGEN_PI).epsilon(1e-14));

    std::mt19937 random(7);
    std::uniform_real_distribution<double> at(-1, 1);
    const auto point = [&] { return Vec2(at(random), at(random)); };
    for (int trial = 0; trial < 20; ++trial) {
        const Vec2 a = point(), b = point(), c = point(), d = point();
        const Loop loop{{a, b, Quadratic{point()}, {}},
                        {b, c, Cubic{point(), point()}, {}},
                        {c, d, Arc{1.2 + std::abs(at(random)), trial % 2 == 0, trial % 3 == 0}, {}},
                        {d, a, Straight{}, {}}};
        CHECK(signed_area(loop) == Approx(polygon_area(loop, 4000)).margin(1e-5));
        Loop back;
        for (auto e = loop.rbegin(); e != loop.rend(); ++e)
            back.push_back(reversed(*e));
        CHECK(signed_area(back) == Approx(-signed_area(loop)).epsilon(1e-10));
    }
}
