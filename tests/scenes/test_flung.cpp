// SPDX-License-Identifier: GPL-3.0-or-later
// Random panels flung at a body end without a crossing. bench_flung runs 200 of these scenes, to rest.
#include "io/read_avatar.h"
#include "tests/support/flung_scene.h"
#include "tests/support/test_data.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double contact_floor = 0.05e-3; // m, that the barrier keeps
constexpr int iterations = 15;            // whether it comes to rest is not asked here

void check(const TriMesh& body, std::uint64_t number) {
    INFO("scene " << number);
    FlungScene s = flung_scene(body, number);
    REQUIRE(s.fabrics.size() >= 2);
    const FlungEnd end = fling(s, iterations);
    CHECK(end.crossing_flight == 0);
    CHECK(end.crossings == 0);
    CHECK(end.nodes_inside == 0);
    CHECK(end.clearance >= contact_floor);
}

} // namespace

TEST_CASE("panels flung at a sphere, a cube and a spiky star cross nothing") {
    const TriMesh bodies[] = {sphere(0.12, 3), box(Vec3::Constant(-0.1), Vec3::Constant(0.1)), spiky_star(0.18)};
    for (int k = 0; k < 9; ++k) check(bodies[k % 3], 1001 + k);
}

TEST_CASE("panels flung at a real body cross nothing") {
    const auto body = test_data("bodies/f_smpl_average_A40.obj");
    if (!body) return;
    const TriMesh mesh = read_avatar(*body).body;
    for (int k = 0; k < 2; ++k) check(mesh, 2001 + k);
}

TEST_CASE("panels flung without contact between them do cross") {
    int crossings = 0;
    for (int k = 0; k < 2; ++k) {
        FlungScene s = flung_scene(spiky_star(0.18), 1001 + k);
        crossings += fling(s, 0, false).crossings;
    }
    CHECK(crossings > 0);
}
