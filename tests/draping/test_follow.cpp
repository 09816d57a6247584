// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/carry.h"
#include "draping/follow.h"
#include "tests/support/cloth_scene.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

#include <Eigen/Geometry>

#include <numbers>

using namespace toile;
using namespace toile::test;
using Catch::Contains;

namespace {

constexpr double degree = std::numbers::pi / 180;

Points turned(Points points, double angle) {
    for (Vec3& p : points) p = Eigen::AngleAxisd(-angle, Vec3::UnitZ()) * p;
    return points;
}

/// A sheet of 0.1 m at rest on a table, and what follow() wants to know of it.
struct OnTable {
    FlatMesh sheet = jittered_rectangle(0.1, 0.1, 0.02, 0.25, 3);
    Garment garment = garment_of(sheet);
    TriMesh body;
    PanelFabrics fabrics{fabric_preset("poplin")};
    DrapeOptions options;
    DrapeResult dressed;
    Staging staging;

    explicit OnTable(TriMesh on, double friction) : body(std::move(on)) {
        Points x;
        for (const Vec2& p : sheet.points) x.push_back({p.x() - 0.05, 0.45e-3, 0.05 - p.y()});
        ClothScene scene(garment, body, x, fabrics[0], {friction});
        REQUIRE(scene.settle_to(1e-3, 200));
        dressed.garment = garment;
        dressed.state.positions = scene.x;
        dressed.friction.body = friction;
        staging.levels.push_back({0.02, garment, scene.x});
    }

    std::vector<FrameReport> follow_to(const std::vector<Points>& frames, Points* at_last = nullptr) {
        FollowOptions how;
        if (at_last) how.done = [at_last](int, const Points& x) { *at_last = x; };
        return follow(staging, dressed, body, frames, fabrics, options, how);
    }
};

TriMesh table() { return box(Vec3(-0.3, -0.1, -0.3), Vec3(0.3, 0, 0.3)); }

/// Table and a plate above it, whose eight points are the last of the mesh.
TriMesh table_and_plate(double above) {
    TriMesh m = table();
    const TriMesh plate = box(Vec3(-0.03, above, -0.03), Vec3(0.03, above + 0.02, 0.03));
    m.points.insert(m.points.end(), plate.points.begin(), plate.points.end());
    for (const Triangle& t : plate.triangles) m.triangles.push_back({8 + t[0], 8 + t[1], 8 + t[2]});
    return m;
}

} // namespace

TEST_CASE("cloth on a body that moves as a whole is carried as a whole, and so are its ties", "[follow]") {
    const TriMesh body = table();
    const FlatMesh sheet = jittered_rectangle(0.1, 0.1, 0.02, 0.25, 3);
    const Garment garment = garment_of(sheet);
    Points x;
    for (const Vec2& p : sheet.points) x.push_back({p.x() - 0.05, 0.4e-3, 0.05 - p.y()});
    const std::vector<Anchor> anchors = find_anchors(x, body);
    for (const Anchor& a : anchors) CHECK(a.distance == Approx(0.4e-3));
    const Vec3 by(0.02, 0.01, -0.03);
    Points moved = body.points;
    for (Vec3& p : moved) p += by;
    std::vector<char> pinned(x.size(), 0);
    Eigen::VectorXd dx = carried(anchors, body, Points(body.points.size(), by), garment.edges, pinned);
    for (std::size_t i = 0; i < x.size(); ++i) CHECK((dx.segment<3>(3 * i) - by).norm() < 1e-9);
    pinned[0] = 1;
    dx = carried(anchors, body, Points(body.points.size(), by), garment.edges, pinned);
    CHECK(dx.head<3>().norm() == 0);
    CHECK((dx.segment<3>(3) - by).norm() < 1e-4);

    Friction friction = friction_at(x, 0.3);
    for (Tie& tie : friction.ties) tie.force = 1;
    const double angle = 40 * degree;
    carry_places(friction, anchors, body, turned(body.points, angle));
    const Points expected = turned(x, angle);
    const Vec3 normal = turned({Vec3::UnitY()}, angle)[0];
    for (std::size_t i = 0; i < x.size(); ++i) {
        CHECK((friction.ties[i].place - expected[i]).norm() < 1e-12);
        CHECK((friction.ties[i].normal - normal).norm() < 1e-12);
    }
}

TEST_CASE("a sheet stays in its place on a board that is tilted to less than the angle of friction", "[follow]") {
    OnTable scene(table(), 0.5);
    const Points at_rest = scene.dressed.state.positions;
    std::vector<Points> frames;
    for (const double a : {8.0, 16.0, 24.0}) frames.push_back(turned(scene.body.points, a * degree)); // 26.6 holds
    Points x;
    for (const FrameReport& r : scene.follow_to(frames, &x)) {
        INFO(r.where);
        CHECK(r.status == FrameStatus::converged);
        CHECK(r.residual <= scene.options.tolerance);
        CHECK(r.behind == 0);
        CHECK(r.intersections.cloth_avatar == 0);
        CHECK(r.substeps > 1);
    }
    const Points expected = turned(at_rest, 24 * degree);
    for (std::size_t i = 0; i < x.size(); ++i) CHECK((x[i] - expected[i]).norm() < 5e-4);
}

TEST_CASE("a body that closes on cloth waits for it, is blocked where there is no room, and comes free again",
          "[follow]") {
    OnTable scene(table_and_plate(0.05), 0.3);
    const auto frames = {table_and_plate(0.004).points, table_and_plate(-0.01).points, table_and_plate(0.03).points};
    const std::vector<FrameReport> r = scene.follow_to(frames);
    REQUIRE(r.size() == 3);
    CHECK(r[0].status == FrameStatus::converged);
    CHECK(r[1].status == FrameStatus::blocked);
    CHECK(r[1].behind > 0.0095);
    CHECK(r[1].intersections.cloth_avatar > 0); // with the body as the frame has it
    CHECK_THAT(r[1].where, Contains("short of the frame") && Contains("is in the way") && Contains("panel \"panel\""));
    INFO(r[2].where);
    CHECK(r[2].status == FrameStatus::converged);
    CHECK(r[2].intersections.cloth_avatar == 0);
}

TEST_CASE("what cannot follow a body is refused", "[follow]") {
    OnTable scene(table(), 0.3);
    CHECK_THROWS_WITH(scene.follow_to({Points(3, Vec3::Zero())}), Contains("another number of points"));
    scene.dressed.state.positions[0].y() = -0.01;
    CHECK_FALSE(can_follow(scene.dressed, scene.body));
    CHECK_THROWS_AS(scene.follow_to({scene.body.points}), std::invalid_argument);
}
