// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/distance.h"
#include "geometry/toi.h"
#include "tests/support/ccd_queries.h"
#include "tests/support/test_data.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <limits>

using namespace toile;

namespace {

using Four = std::array<Vec3, 4>;
using Kind = PairKind;

double toi(Kind kind, const Motion& m, const ToiOptions& options) {
    return kind == Kind::point_triangle ? time_of_impact_point_triangle(m, options)
                                        : time_of_impact_edge_edge(m, options);
}

double distance_at(Kind kind, const Motion& m, double t) {
    Four x = m.x;
    for (int k = 0; k < 4; ++k)
        x[k] += t * m.dx[k];
    return std::sqrt(kind == Kind::point_triangle ? nearest_point_triangle(x[0], x[1], x[2], x[3]).squared
                                                  : nearest_edge_edge(x[0], x[1], x[2], x[3]).squared);
}

const auto between = test::motion_between;

/// An exact time of impact, by hand. t < 0: none.
struct Known {
    const char* name;
    Kind kind;
    Four x0, x1;
    double t;
};

const Four rest = {Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};

Four with_point(const Vec3& p) {
    return {p, rest[1], rest[2], rest[3]};
}

// The point falls on a triangle at rest, or edge b falls on edge a at rest, from height 1 to -1 in unit time,
// unless said otherwise: contact at 1/2.
const std::vector<Known> known = {
    {"through the face", Kind::point_triangle, with_point({.25, .25, 1}), with_point({.25, .25, -1}), .5},
    {"through a corner", Kind::point_triangle, with_point({0, 0, 1}), with_point({0, 0, -1}), .5},
    {"through a side", Kind::point_triangle, with_point({.5, 0, 1}), with_point({.5, 0, -1}), .5},
    {"touches at the end", Kind::point_triangle, with_point({.25, .25, 1}), with_point({.25, .25, 0}), 1},
    {"touches at the start", Kind::point_triangle, with_point({.25, .25, 0}), with_point({.25, .25, 1}), 0},
    // In the plane all the time; from x = -1 to 1/2 it meets the side x = 0 after two thirds.
    {"slides in, in the plane", Kind::point_triangle, with_point({-1, .25, 0}), with_point({.5, .25, 0}),
     2. / 3},
    {"slides past, in the plane", Kind::point_triangle, with_point({-1, 2, 0}), with_point({1, 2, 0}), -1},
    // Corner c rises to 2 t; the face above (1/4, 1/2) is at z = t, the point at 1 - t.
    {"meets a rising face",
     Kind::point_triangle,
     with_point({.25, .5, 1}),
     {Vec3(.25, .5, 0), rest[1], rest[2], Vec3(0, 1, 2)},
     .5},
    // y = 3/4 - t/2; face at 8 t y = 6 t - 4 t^2, point at 1 + 2 t: their difference 1 - 4 t + 4 t^2 = (1 - 2
    // t)^2.
    {"grazes the face",
     Kind::point_triangle,
     with_point({.125, .75, 1}),
     {Vec3(.125, .25, 3), rest[1], rest[2], Vec3(0, 1, 8)},
     .5},
    {"edges cross",
     Kind::edge_edge,
     {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(0, -1, 1), Vec3(0, 1, 1)},
     {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(0, -1, -1), Vec3(0, 1, -1)},
     .5},
    {"parallel edges collide",
     Kind::edge_edge,
     {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(2, 0, 1)},
     {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, -1), Vec3(2, 0, -1)},
     .5},
    {"parallel edges touch end to end",
     Kind::edge_edge,
     {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, 1), Vec3(2, 0, 1)},
     {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, -1), Vec3(2, 0, -1)},
     .5},
    {"parallel edges pass beside each other",
     Kind::edge_edge,
     {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(1.5, 0, 1), Vec3(2, 0, 1)},
     {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(1.5, 0, -1), Vec3(2, 0, -1)},
     -1},
    {"end meets end",
     Kind::edge_edge,
     {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, 1), Vec3(1, 1, 2)},
     {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, -1), Vec3(1, 1, 0)},
     .5},
    {"an edge of no length",
     Kind::edge_edge,
     {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, 1)},
     {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, -1), Vec3(0, 0, -1)},
     .5},
    // Edge b goes from (0, -1, 1)-(0, 1, 1) to (0, -1, 1)-(0, 1, -3): at y = 0 its height is 1 - 2 t.
    {"an edge tilts through",
     Kind::edge_edge,
     {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(0, -1, 1), Vec3(0, 1, 1)},
     {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(0, -1, 1), Vec3(0, 1, -3)},
     .5},
};

void check_against_exact(const std::string& name, Kind kind, const Motion& m, bool hit, double exact) {
    INFO(name);
    for (double keep : {0.5, 0.1, 1e-3}) {
        const double t = toi(kind, m, {keep});
        if (hit) CHECK(t <= exact);
        if (hit && exact > 0) CHECK(t < 1);
        const double start = distance_at(kind, m, 0);
        if (t < 1 && start > 1e-12) CHECK(distance_at(kind, m, t) <= 1.06 * keep * start);
        if (hit && keep == 1e-3) CHECK(t >= exact - 0.04); // a graze comes near as the root of the gap
    }
}

Motion random_motion(test::Random& random, double size, double speed, const Vec3& origin) {
    Motion m;
    const Vec3 common = random.vec3(10 * speed);
    for (int k = 0; k < 4; ++k) {
        m.x[k] = origin + random.vec3(size);
        m.dx[k] = common + random.vec3(speed);
    }
    return m;
}

} // namespace

TEST_CASE("time of impact of motions whose time is known") {
    for (const Known& k : known)
        for (double offset : {0.0, 2.0, 0x1p20}) {
            Four x0 = k.x0, x1 = k.x1;
            for (int i = 0; i < 4; ++i) {
                x0[i] += Vec3::Constant(offset);
                x1[i] += Vec3::Constant(offset);
            }
            check_against_exact(k.name, k.kind, between(x0, x1), k.t >= 0, k.t);
            if (k.t < 0) CHECK(toi(k.kind, between(x0, x1), {0.1}) == 1);
        }
}

TEST_CASE("the distance kept is the one asked for, all the way, and no more than needed") {
    test::Random random(8);
    int stopped = 0;
    for (int k = 0; k < 2000; ++k) {
        const double size = k % 2 ? 0.01 : 1e-4;
        const Vec3 origin = k % 3 ? Vec3(1.3, 1.7, -0.4) : Vec3(0, 0, 0);
        const Motion m = random_motion(random, size, size * (k % 5), origin);
        for (Kind kind : {Kind::point_triangle, Kind::edge_edge}) {
            const double start = distance_at(kind, m, 0);
            ToiOptions options;
            options.keep = k % 7 ? 0.1 : 0.6;
            options.min_distance = k % 4 ? 0 : 0.3 * start;
            const double kept = options.min_distance + options.keep * (start - options.min_distance);
            const double t = toi(kind, m, options);
            REQUIRE(t > 0);
            REQUIRE(t <= 1);
            for (int i = 0; i <= 64; ++i)
                CHECK(distance_at(kind, m, t * i / 64) >= kept - 1e-15);
            if (t == 1) continue;
            ++stopped;
            const double above = distance_at(kind, m, t) - kept;
            CHECK(above <= 0.06 * options.keep * (start - options.min_distance) + 1e-13);
        }
    }
    CHECK(stopped > 500);
}

TEST_CASE("a gap of a micrometre far from the origin is neither crossed nor a reason to stop") {
    const Vec3 o(1.4, 1.7, -1.1);
    const Four x0 = {o + Vec3(.002, .002, 1e-6), o, o + Vec3(.01, 0, 0), o + Vec3(0, .01, 0)};
    const auto moved = [&](const Vec3& d) {
        return Motion{x0, {d, Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(0, 0, 0)}};
    };
    CHECK(time_of_impact_point_triangle(moved({.004, .001, 0}), {}) == 1); // slides along
    CHECK(time_of_impact_point_triangle(moved({0, 0, 1e-3}), {}) == 1);    // leaves
    CHECK(time_of_impact_point_triangle(moved({0, 0, -1e-3}), {}) == Approx(9e-4).epsilon(0.01));
    CHECK(time_of_impact_point_triangle(moved({0, 0, -1e-3}), {0.1, 0.5e-6}) == Approx(4.5e-4).epsilon(0.06));
}

TEST_CASE("no motion, common motion, a start below the distance to keep, and motions that are no numbers") {
    test::Random random(9);
    Motion m = random_motion(random, 1, 0, Vec3(0, 0, 0));
    for (Vec3& d : m.dx)
        d.setZero();
    for (Kind kind : {Kind::point_triangle, Kind::edge_edge}) {
        CHECK(toi(kind, m, {}) == 1);
        const double start = distance_at(kind, m, 0);
        CHECK(toi(kind, m, {0.1, start * 1.001}) == 0);
        CHECK(toi(kind, m, {0.1, start * 0.999}) == 1);
        Motion common = m;
        for (Vec3& d : common.dx)
            d = Vec3(100, -7, 3);
        CHECK(toi(kind, common, {}) == 1);
        common.dx[2][1] = std::numeric_limits<double>::quiet_NaN();
        CHECK(toi(kind, common, {}) == 0);
        common.dx[2][1] = std::numeric_limits<double>::infinity();
        CHECK(toi(kind, common, {}) == 0);
    }
}

TEST_CASE("time of impact of the reference queries with exact times") {
    const auto path = test::reference_data("ccd_analytic.json");
    if (!path) return;
    std::ifstream file(*path);
    const auto queries = nlohmann::json::parse(file).at("queries");
    REQUIRE(queries.size() == 66);
    for (const auto& q : queries) {
        Four x0, x1;
        for (int k = 0; k < 4; ++k)
            for (int c = 0; c < 3; ++c) {
                x0[k][c] = q["points_t0"][k][c];
                x1[k][c] = q["points_t1"][k][c];
            }
        const bool hit = q["hit"];
        const Kind kind = q["kind"] == "vertex-face" ? Kind::point_triangle : Kind::edge_edge;
        const Motion m = between(x0, x1);
        check_against_exact(q["name"], kind, m, hit, hit ? q["toi"].get<double>() : -1.0);
        CHECK(exactly_touch(kind, x0, x1) == hit);
        if (hit) CHECK(test::toi_touch(kind, m, 0));
        if (hit) CHECK(test::toi_touch(kind, m, 1e-6));
    }
}

namespace {

/// Whether some time of the motion brings the pair within `limit`; may fail to find it, but what it finds is
/// there.
bool comes_within(Kind kind, const Motion& m, double limit) {
    double best = 0;
    for (int i = 0; i <= 1000; ++i)
        if (distance_at(kind, m, i / 1000.) < distance_at(kind, m, best)) best = i / 1000.;
    double low = std::max(0.0, best - 1e-3), high = std::min(1.0, best + 1e-3);
    for (int k = 0; k < 100; ++k) { // golden section
        const double a = low + 0.382 * (high - low), b = low + 0.618 * (high - low);
        if (distance_at(kind, m, a) < distance_at(kind, m, b))
            high = b;
        else
            low = a;
    }
    return std::min(distance_at(kind, m, best), distance_at(kind, m, low)) <= limit;
}

} // namespace

TEST_CASE("no query of the public collection with a collision is passed, and none beyond the tolerance is "
          "stopped") {
    const auto folder = test::reference_data("ccd");
    if (!folder) return;
    std::array<int, 2> queries{}, contacts{}, missed{}, missed_within{}, stopped{}, stopped_within{}, apart{};
    int wrong_truth = 0, wrong_contact = 0, late = 0;
    for (const test::CcdQuery& q : test::read_ccd_queries(*folder)) {
        const int k = int(q.kind);
        const Motion m = between(q.from, q.to);
        const bool touch = test::toi_touch(q.kind, m, 0), near = test::toi_touch(q.kind, m, 1e-6);
        ++queries[k];
        contacts[k] += q.touch;
        missed[k] += q.touch && !touch;
        missed_within[k] += q.touch && !near;
        stopped[k] += !q.touch && touch;
        stopped_within[k] += !q.touch && near;
        apart[k] += near && !comes_within(q.kind, m, 1e-6);
        wrong_truth += exactly_touch(q.kind, q.from, q.to) != q.touch;
        const std::optional<double> t = time_of_contact(q.kind, q.from, q.to, {.min_distance = 1e-6});
        wrong_contact += t.has_value() != q.touch;
        if (!t) continue;
        Motion until = m;
        for (Vec3& d : until.dx) d *= *t;
        late += *t > 0 && exactly_touch(q.kind, until);
    }
    CHECK(queries == std::array{3085, 4194});
    CHECK(contacts == std::array{248, 187});
    CHECK(missed == std::array{0, 0});
    CHECK(missed_within == std::array{0, 0});
    CHECK(wrong_truth == 0);   // exact arithmetic agrees with the collection
    CHECK(wrong_contact == 0); // and so does what asks it only where the pair comes near
    CHECK(late == 0);
    // Of the misses 390 come within 1e-10, most of them within the rounding of their coordinates, and all
    // that are stopped at a distance of 1e-6 do come within it.
    CHECK(apart == std::array{0, 0});
    CHECK(stopped[0] <= 145);
    CHECK(stopped[1] <= 210);
    CHECK(stopped_within == std::array{172, 256});
}

TEST_CASE("a random search against exact arithmetic finds no contact that is missed") {
    test::Random random(21);
    int contacts = 0, missed = 0, passed = 0, stopped = 0, wrong = 0, late = 0;
    constexpr int families = int(test::CcdFamily::count), each = 1000;
    for (int k = 0; k < families * 2 * each; ++k) {
        const auto family = test::CcdFamily(k / 2 % families);
        const Kind kind = Kind(k % 2);
        double size;
        const Motion m = test::random_ccd_query(family, kind, random, size);
        const bool touch = exactly_touch(kind, m);
        // Searching for the last digits of a distance of nothing takes long, and ends with a time below 1 the
        // sooner.
        const double t = toi(kind, m, {1e-9, 0, 1000});
        contacts += touch;
        missed += touch && t == 1;
        stopped += t < 1 && !touch;
        const std::optional<double> contact = time_of_contact(kind, m, {.min_distance = 1e-6 * size});
        wrong += contact.has_value() != touch;
        if (!touch) continue;
        const double free = toi(kind, m, {});
        Motion allowed = m;
        for (Vec3& d : allowed.dx)
            d *= free;
        passed += free > 0 && exactly_touch(kind, allowed);
        if (!contact) continue;
        allowed = m;
        for (Vec3& d : allowed.dx)
            d *= *contact;
        late += *contact > 0 && exactly_touch(kind, allowed);
    }
    CHECK(contacts > 2500);
    CHECK(missed == 0);
    CHECK(passed == 0);
    CHECK(wrong == 0);
    CHECK(late == 0);
    CHECK(stopped < 3000); // near misses on purpose, nearer than rounding
}

TEST_CASE("numbers too large for their products stop a motion rather than let it through") {
    for (const double size : {1e60, 1e80, 1e120, 1e300, 1e-60, 1e-120, 1e-300})
        for (const Known& k : known) {
            Motion m = between(k.x0, k.x1);
            for (int i = 0; i < 4; ++i) {
                m.x[i] *= size;
                m.dx[i] *= size;
            }
            INFO(k.name << " times " << size);
            if (k.t >= 0) CHECK(toi(k.kind, m, {}) < 1);
        }
}
