// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/toi_cubic.h"
#include "tests/support/ccd_queries.h"
#include "tests/support/test_data.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <fstream>

using namespace toile;

namespace {

Motion point_falls(const Vec3& from, const Vec3& to) {
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), still(0, 0, 0);
    return {{from, a, b, c}, {to - from, still, still, still}};
}

} // namespace

TEST_CASE("the cubic finds plain contacts, with their time") {
    CHECK(cubic_toi_point_triangle(point_falls({.25, .25, 1}, {.25, .25, -3}), 0).value() == Approx(.25));
    CHECK(!cubic_toi_point_triangle(point_falls({.75, .75, 1}, {.75, .75, -1}), 0));
    CHECK(!cubic_toi_point_triangle(point_falls({.25, .25, 1}, {.25, .25, .5}), 0));
    CHECK(!cubic_toi_point_triangle(point_falls({.5, -1e-3, 1}, {.5, -1e-3, -1}), 0));
    CHECK(cubic_toi_point_triangle(point_falls({.5, -1e-3, 1}, {.5, -1e-3, -1}), 2e-3));
    const Vec3 still(0, 0, 0), down(0, 0, -4);
    const std::array<Vec3, 4> cross = {Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(0, -1, 1), Vec3(0, 1, 1)};
    CHECK(cubic_toi_edge_edge({cross, {still, still, down, down}}, 0).value() == Approx(.25));
    CHECK(!cubic_toi_edge_edge({cross, {still, still, -down, -down}}, 0));
}

TEST_CASE("the first of three roots is found, and the ones outside of the triangle are skipped") {
    test::Random random(4);
    int found = 0;
    for (int k = 0; k < 20000; ++k) {
        const PairKind kind = PairKind(k % 2);
        Motion m;
        for (int i = 0; i < 4; ++i) {
            m.x[i] = random.vec3();
            m.dx[i] = random.vec3(3);
        }
        const auto t =
            kind == PairKind::point_triangle ? cubic_toi_point_triangle(m, 0) : cubic_toi_edge_edge(m, 0);
        CHECK(t.has_value() == exactly_touch(kind, m)); // nothing here is degenerate
        if (!t) continue;
        ++found;
        Motion before = m, until = m;
        for (int i = 0; i < 4; ++i) {
            before.dx[i] *= *t - 1e-9;
            until.dx[i] *= *t + 1e-9;
        }
        CHECK(!exactly_touch(kind, before));
        CHECK(exactly_touch(kind, until));
    }
    CHECK(found > 1000);
}

TEST_CASE("what the cubic cannot do: a contact within one plane is passed at any tolerance") {
    const Motion slide =
        point_falls({-1, .25, 0}, {3, .25, 0}); // through the triangle, both ends outside of it
    CHECK(exactly_touch(PairKind::point_triangle, slide));
    for (const double tolerance : {0.0, 1e-6, 1e-3})
        CHECK(!test::cubic_touch(PairKind::point_triangle, slide, tolerance));
    CHECK(test::toi_touch(PairKind::point_triangle, slide, 0));
}

TEST_CASE("what the cubic cannot do: contacts in one plane, without closing speed, and of parallel edges") {
    test::Random random(6);
    for (const auto family :
         {test::CcdFamily::sliding, test::CcdFamily::grazing, test::CcdFamily::parallel}) {
        int contacts = 0, missed = 0, missed_by_toi = 0;
        for (int k = 0; k < 3000; ++k) {
            const PairKind kind = PairKind(k % 2);
            double size;
            const Motion m = test::random_ccd_query(family, kind, random, size);
            if (!exactly_touch(kind, m)) continue;
            ++contacts;
            missed += !test::cubic_touch(kind, m, 1e-6 * size);
            missed_by_toi += !test::toi_touch(kind, m, 1e-6 * size);
        }
        INFO(test::name_of(family) << ": " << missed << " of " << contacts);
        CHECK(contacts > 300);
        CHECK(missed > contacts / 20);
        CHECK(missed_by_toi == 0);
    }
}

TEST_CASE("the cubic misses contacts of the public collection and calls what is apart a contact") {
    const auto folder = test::reference_data("ccd");
    if (!folder) return;
    std::array<int, 2> missed_exact{}, missed{}, false_exact{}, false_alarms{};
    for (const test::CcdQuery& q : test::read_ccd_queries(*folder)) {
        const Motion m = test::motion_between(q.from, q.to);
        const bool exact = test::cubic_touch(q.kind, m, 0), tolerant = test::cubic_touch(q.kind, m, 1e-6);
        missed_exact[int(q.kind)] += q.touch && !exact;
        missed[int(q.kind)] += q.touch && !tolerant;
        false_exact[int(q.kind)] += exact && !q.touch;
        false_alarms[int(q.kind)] += tolerant && !q.touch;
    }
    // Point-triangle, edge-edge. Which ones go wrong hangs on the last digits of the roots.
    CHECK(missed_exact == std::array{1, 2});
    CHECK(missed == std::array{1, 1});
    CHECK(false_exact == std::array{17, 28});
    CHECK(false_alarms == std::array{113, 162});
}

TEST_CASE("the cubic on the reference queries with exact times") {
    const auto path = test::reference_data("ccd_analytic.json");
    if (!path) return;
    std::ifstream file(*path);
    const auto queries = nlohmann::json::parse(file).at("queries");
    REQUIRE(queries.size() == 66);
    std::vector<std::string> missed, false_alarms;
    for (const auto& q : queries) {
        std::array<Vec3, 4> x0, x1;
        for (int k = 0; k < 4; ++k)
            for (int c = 0; c < 3; ++c) {
                x0[k][c] = q["points_t0"][k][c];
                x1[k][c] = q["points_t1"][k][c];
            }
        const PairKind kind = q["kind"] == "vertex-face" ? PairKind::point_triangle : PairKind::edge_edge;
        const bool found = test::cubic_touch(kind, test::motion_between(x0, x1), 1e-6);
        const bool touch = q["hit"];
        if (touch && !found) missed.push_back(q["name"]);
        if (found && !touch) false_alarms.push_back(q["name"]);
    }
    // Parallel edges, and an edge that is a point: the cubic is zero all the time.
    CHECK(missed == std::vector<std::string>{"parallel_collide", "parallel_endpoint_touch",
                                             "zero_length_edge", "parallel_collide_offset_2^20"});
    CHECK(false_alarms == std::vector<std::string>{"miss_by_2^-50"}); // within the tolerance
}
