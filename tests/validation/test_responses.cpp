// SPDX-License-Identifier: GPL-3.0-or-later
// What each response to contact does, and where it fails: docs/responses.md.

#include "draping/contact/response.h"
#include "tests/support/dropped_sheet.h"
#include "tests/support/particles.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double g = 9.81;
constexpr double mass = 1e-4; // kg per node

std::unique_ptr<Response> response_of(ContactResponse kind, const Particles& p, const TriMesh& body,
                                      const ResponseOptions& o) {
    return make_response(kind, p.cloth, body, o);
}

Particles one_triangle(double height) { return {level_triangle(height), {{0, 2, 1}}, mass}; }

TriMesh moved(TriMesh mesh, const Vec3& by) {
    for (Vec3& p : mesh.points) p += by;
    return mesh;
}

/// An upright pyramid whose tip is at `tip`.
TriMesh spike(const Vec3& tip, double height, double width) {
    const double w = width / 2, y = tip.y() - height;
    TriMesh m;
    m.points = {tip, {tip.x() - w, y, tip.z() - w}, {tip.x() + w, y, tip.z() - w}, {tip.x() + w, y, tip.z() + w},
                {tip.x() - w, y, tip.z() + w}};
    m.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 4, 3}, {0, 1, 4}, {1, 2, 3}, {1, 3, 4}};
    return m;
}

/// A box turned by 45 degrees about the z axis: an edge, 0.4 m long, lies uppermost at y = 0.
TriMesh edge_up() {
    TriMesh m = box(Vec3(-0.05, -0.05, -0.2), Vec3(0.05, 0.05, 0.2));
    const Mat3 turn = Eigen::AngleAxisd(std::numbers::pi / 4, Vec3::UnitZ()).toRotationMatrix();
    for (Vec3& p : m.points) p = turn * p - Vec3(0, 0.05 * std::sqrt(2.0), 0);
    return m;
}

} // namespace

TEST_CASE("penalty: what rests on a floor sinks into the thickness by m g / k", "[responses]") {
    ResponseOptions o;
    o.separation_share = 1;
    o.normal_damping = 5e-3;
    for (const double k : {0.5, 1.0, 5.0}) {
        o.stiffness = k;
        Particles p = one_triangle(o.thickness);
        const auto response = response_of(ContactResponse::penalty, p, floor_face(), o);
        ResponseDone done;
        for (int i = 0; i < 5000; ++i) done = p.step(*response, 1e-3);
        for (int i = 0; i < 3; ++i) {
            CHECK(p.x[i].y() == Approx(o.thickness - mass * g / k).margin(1e-9));
            CHECK(done.other_force[i].y() == Approx(mass * g));
        }
        if (k == 1) CHECK(p.x[0].y() < 0); // m g / k is more than the thickness: below the floor
    }
    CHECK(std::string(to_string(response_of(ContactResponse::penalty, one_triangle(1), floor_face(), o)->guarantee())) ==
          "none");
}

TEST_CASE("penalty: a weaker spring on the way out chatters, and one too stiff for the step explodes", "[responses]") {
    ResponseOptions o;
    o.stiffness = 5;
    o.separation_share = 0.5;
    Particles p = one_triangle(o.thickness);
    const auto response = response_of(ContactResponse::penalty, p, floor_face(), o);
    int turns = 0;
    double last = 0, fastest = 0, lowest = 1, highest = -1;
    for (int i = 0; i < 6000; ++i) {
        p.step(*response, 1e-3);
        if (i < 5000) continue;
        turns += p.v[0].y() * last < 0;
        last = p.v[0].y();
        fastest = std::max(fastest, std::abs(last));
        lowest = std::min(lowest, p.x[0].y());
        highest = std::max(highest, p.x[0].y());
    }
    INFO(turns << " turns, " << fastest << " m/s, " << lowest << " to " << highest);
    CHECK(turns > 100);     // five seconds after it was laid down
    CHECK(fastest > 1e-3);  // m/s
    CHECK(highest > lowest);
    CHECK(o.thickness - lowest >= mass * g / o.stiffness); // and floats between what either spring bears

    o.stiffness = 5 * mass / 1e-6; // dt2 k / m = 5
    o.separation_share = 1;
    Particles q = one_triangle(o.thickness);
    const auto stiff = response_of(ContactResponse::penalty, q, floor_face(), o);
    double jump = 0;
    for (int i = 0; i < 1000; ++i) {
        q.step(*stiff, 1e-3);
        jump = std::max(jump, q.x[0].y());
    }
    CHECK(jump > 0.01);
}

TEST_CASE("penalty: fast cloth passes through the body, friction creeps", "[responses]") {
    ResponseOptions o;
    Particles p = one_triangle(0.05);
    for (Vec3& v : p.v) v.y() = -20;
    const auto response = response_of(ContactResponse::penalty, p, floor_face(), o);
    for (int i = 0; i < 100; ++i) p.step(*response, 1e-3);
    CHECK(p.x[0].y() < -0.5);

    // Tilted by less than the angle of friction: a damper stands in for friction at rest.
    o.stiffness = 5;
    o.normal_damping = 5e-3;
    o.body_friction = 0.6;
    Particles q = one_triangle(o.thickness);
    TriMesh slope = floor_face();
    const double angle = 0.3;
    for (Points* points : {&slope.points, &q.x})
        for (Vec3& at : *points) at = Eigen::AngleAxisd(-angle, Vec3::UnitZ()) * at;
    const auto creeping = response_of(ContactResponse::penalty, q, slope, o);
    o.separation_share = 1;
    for (int i = 0; i < 5000; ++i) q.step(*creeping, 1e-3);
    CHECK(q.v[0].norm() == Approx(mass * g * std::sin(angle) / o.tangential_damping).epsilon(0.1));
}

TEST_CASE("constraint: holds a node where it meets a face, moves with it, and lets go when it pulls", "[responses]") {
    ResponseOptions o;
    o.body_friction = 0.5;
    Particles p = one_triangle(0.01);
    const auto response = response_of(ContactResponse::constraint, p, floor_face(), o);
    CHECK(std::string(to_string(response->guarantee())) == "no_node_in_body");
    ResponseDone done;
    for (int i = 0; i < 200; ++i) done = p.step(*response, 1e-3);
    CHECK(done.held == 3);
    for (int i = 0; i < 3; ++i) {
        CHECK(p.v[i].norm() == 0); // at once, without a bounce, and still
        CHECK(p.x[i].y() == Approx(o.thickness).epsilon(0.05));
        CHECK(done.touches[i].point[0] == i);
        CHECK((done.touches[i].force - Vec3(0, mass * g, 0)).norm() < 1e-9);
    }
    // The face rises at 0.1 m/s and slides at 0.2 m/s: friction takes the nodes along.
    TriMesh body = floor_face();
    for (int i = 0; i < 200; ++i) {
        body = moved(body, 1e-3 * Vec3(0.2, 0.1, 0));
        done = p.step(*response, 1e-3, body.points);
    }
    CHECK((p.v[0] - Vec3(0.2, 0.1, 0)).norm() < 1e-9);
    CHECK(done.held == 3);
    // It sinks faster than anything falls: the nodes are let go and fall freely.
    for (int i = 0; i < 50; ++i) {
        body = moved(body, 1e-3 * Vec3(0, -2, 0));
        done = p.step(*response, 1e-3, body.points);
    }
    CHECK(done.held == 0);
    CHECK(p.v[0].y() == Approx(0.1 - 50 * 1e-3 * g));
    CHECK(done.touches.empty()); // the floor is out of reach
}

TEST_CASE("constraint: edges of the body and the cloth itself are missed, where impulses stop them", "[responses]") {
    const TriMesh ridge = edge_up();
    for (const auto& [kind, stopped] : {std::pair{ContactResponse::constraint, false},
                                        std::pair{ContactResponse::impulse, true},
                                        std::pair{ContactResponse::rigid, true}}) {
        INFO(to_string(kind));
        // A triangle across the ridge, which no node of it meets and whose corner lies beyond its ends.
        Particles over({{-0.3, 0.02, 0}, {0.3, 0.02, 0.01}, {0.3, 0.02, -0.01}}, {{0, 1, 2}}, mass);
        const auto response = response_of(kind, over, ridge, {});
        for (int i = 0; i < 100; ++i) over.step(*response, 1e-3);
        const int cut = count_intersections(over.cloth.triangles, over.x, ridge).cloth_avatar;
        CHECK((cut > 0) == !stopped);

        Particles two = stacked_sheets(2, 2, 0.03, 0.01, 0.01, mass);
        const auto between = response_of(kind, two, floor_face(), {});
        int crossed = 0;
        for (int i = 9; i < 18; ++i) two.v[i].y() = -1; // the upper one falls on the lower
        for (int i = 0; i < 100; ++i) {
            two.step(*between, 1e-3);
            crossed += two.x[9].y() < two.x[0].y();
        }
        CHECK((crossed > 0) == !stopped);
    }
}

TEST_CASE("impulse: sweeps over N stacked sheets grow as N squared", "[responses]") {
    // Sheets that touch their neighbours alone, and come down together: only the lowest learns of the floor at first.
    const auto sweeps = [](int count) {
        ResponseOptions o;
        o.repulsion_sweeps = 100000;
        Particles p = stacked_sheets(count, 1, 0.02, 0.8 * o.thickness, 0.8 * o.thickness, mass);
        for (Vec3& v : p.v) v.y() = -0.1;
        const auto response = response_of(ContactResponse::impulse, p, floor_face(), o);
        const ResponseDone done = p.step(*response, 1e-3);
        CHECK(done.unresolved == 0);
        return done.repulsion_sweeps;
    };
    const int s4 = sweeps(4), s8 = sweeps(8), s16 = sweeps(16);
    INFO(s4 << ", " << s8 << " and " << s16 << " sweeps over 4, 8 and 16 sheets");
    CHECK(double(s8) / s4 > 2.8);
    CHECK(double(s8) / s4 < 5);
    CHECK(double(s16) / s8 > 2.8);
    CHECK(double(s16) / s8 < 5);
}

TEST_CASE("impulse: what the sweeps leave, zones take", "[responses]") {
    ResponseOptions o;
    o.impulse_sweeps = 2;
    Particles p = stacked_sheets(8, 2, 0.02, 0.01, 0.2e-3, mass);
    for (Vec3& v : p.v) v.y() = -10.05;
    const auto response = response_of(ContactResponse::impulse, p, floor_face(), o);
    const ResponseDone done = p.step(*response, 1e-3);
    CHECK(done.sweeps == 2);
    CHECK(done.zones > 0);
    CHECK(done.unresolved == 0);
    for (int s = 0; s + 1 < 8; ++s) CHECK(p.x[9 * s].y() < p.x[9 * (s + 1)].y());
}

TEST_CASE("what comes nearer than impacts may, but does not touch, is not unresolved", "[responses]") {
    // Neither sweeps nor zones: what the start has in store happens.
    ResponseOptions o;
    o.repulsion_sweeps = o.impulse_sweeps = o.zone_rounds = 0;
    const auto unresolved = [&](ContactResponse kind, double end) {
        Particles p = one_triangle(0.5 * o.thickness);
        p.gravity = 0;
        for (double& m : p.inverse_mass) m = 0; // led: no constraint holds it
        for (Vec3& v : p.v) v.y() = (end - 0.5 * o.thickness) / 1e-3;
        return p.step(*response_of(kind, p, floor_face(), o), 1e-3).unresolved;
    };
    for (const ContactResponse kind : {ContactResponse::impulse, ContactResponse::constraint}) {
        INFO(to_string(kind));
        CHECK(unresolved(kind, 0.01 * o.thickness) == 0);
        CHECK(unresolved(kind, 1e-9 * o.thickness) == 0);
        CHECK(unresolved(kind, -1e-9 * o.thickness) > 0);
    }
}

TEST_CASE("impulses and zones keep the momentum of cloth that meets cloth", "[responses]") {
    for (const ContactResponse kind : {ContactResponse::impulse, ContactResponse::rigid}) {
        INFO(to_string(kind));
        Particles p = stacked_sheets(2, 3, 0.02, 0, 2e-3, mass);
        p.gravity = 0;
        Random random(3);
        for (std::size_t i = 0; i < p.v.size(); ++i)
            p.v[i] = Vec3(0, i < 16 ? 0.5 : -0.5, 0) + random.vec3(0.05);
        const auto momenta = [&](Vec3& linear, Vec3& angular) {
            linear = angular = Vec3::Zero();
            for (std::size_t i = 0; i < p.v.size(); ++i) {
                linear += mass * p.v[i];
                angular += mass * p.x[i].cross(p.v[i]);
            }
        };
        Vec3 linear, angular, linear_after, angular_after;
        momenta(linear, angular);
        const Points x = p.x;
        const auto response = response_of(kind, p, {}, {});
        const ResponseDone done = p.step(*response, 5e-3);
        p.x = x; // of the velocities that the step had
        momenta(linear_after, angular_after);
        CHECK(done.impulses + done.zones > 0);
        CHECK(done.unresolved == 0);
        CHECK((linear_after - linear).norm() < 1e-12);
        if (kind == ContactResponse::rigid) CHECK((angular_after - angular).norm() < 1e-12);
    }
}

TEST_CASE("rigid zones weld: no friction, and yet nothing slides", "[responses]") {
    ResponseOptions o;
    o.body_friction = o.cloth_friction = 0;
    const double angle = 0.5;
    for (const ContactResponse kind : {ContactResponse::rigid, ContactResponse::impulse}) {
        INFO(to_string(kind));
        Particles p = one_triangle(2 * o.thickness);
        TriMesh slope = floor_face();
        for (Points* points : {&slope.points, &p.x})
            for (Vec3& at : *points) at = Eigen::AngleAxisd(-angle, Vec3::UnitZ()) * at;
        const auto response = response_of(kind, p, slope, o);
        for (int i = 0; i < 500; ++i) p.step(*response, 1e-3);
        const Vec3 down(std::cos(angle), -std::sin(angle), 0);
        if (kind == ContactResponse::rigid)
            for (const Vec3& v : p.v) CHECK(v.norm() == 0);
        else
            CHECK(p.v[0].dot(down) == Approx(0.5 * g * std::sin(angle)).epsilon(0.01));
    }
}

TEST_CASE("friction of impulses and constraints holds and slides by Coulomb's law", "[responses]") {
    const double angle = 0.4, limit = std::tan(angle);
    for (const ContactResponse kind : {ContactResponse::impulse, ContactResponse::constraint})
        for (const double share : {0.8, 0.99, 1.01, 1.2}) {
            INFO(to_string(kind) << " with " << share << " of what holds");
            ResponseOptions o;
            o.body_friction = share * limit;
            Particles p = one_triangle(o.thickness);
            TriMesh slope = floor_face();
            for (Points* points : {&slope.points, &p.x})
                for (Vec3& at : *points) at = Eigen::AngleAxisd(-angle, Vec3::UnitZ()) * at;
            const auto response = response_of(kind, p, slope, o);
            for (int i = 0; i < 200; ++i) p.step(*response, 1e-3);
            const double speed = p.v[0].dot(Vec3(std::cos(angle), -std::sin(angle), 0));
            const double expected = g * (std::sin(angle) - o.body_friction * std::cos(angle)) * 0.2;
            CHECK(speed == Approx(std::max(0.0, expected)).margin(1e-6).epsilon(0.02));
        }
}

TEST_CASE("friction of cloth on cloth has a coefficient of its own", "[responses]") {
    // The lower sheet lies on a floor that holds it; the upper one is given a push.
    for (const double coefficient : {0.0, 0.5}) {
        ResponseOptions o;
        o.body_friction = 10;
        o.cloth_friction = coefficient;
        Particles p = stacked_sheets(2, 4, 0.02, o.thickness, o.thickness, mass);
        for (std::size_t i = 25; i < p.x.size(); ++i) {
            p.x[i] += Vec3(0.003, 0, 0.002); // no corner above a corner
            p.v[i] = {0.1, 0, 0};
        }
        const auto response = response_of(ContactResponse::impulse, p, floor_face(), o);
        for (int i = 0; i < 10; ++i) p.step(*response, 1e-3);
        Vec3 upper = Vec3::Zero(), lower = Vec3::Zero();
        for (int i = 0; i < 25; ++i) {
            lower += p.v[i] / 25;
            upper += p.v[25 + i] / 25;
        }
        CHECK(std::abs(lower.x()) < 1e-4);
        CHECK(upper.x() == Approx(0.1 - coefficient * g * 0.01).epsilon(0.1));
    }
}

TEST_CASE("cloth dropped on a spike, a needle and an edge ends without a crossing", "[responses]") {
    const struct {
        const char* name;
        TriMesh body;
    } scenes[] = {{"spike", spike({0.003, 0, 0.002}, 0.1, 0.06)},
                  {"needle", spike({0.003, 0, 0.002}, 0.1, 0.002)},
                  {"edge", edge_up()}};
    for (const auto& scene : scenes)
        for (const ContactResponse kind : {ContactResponse::impulse, ContactResponse::rigid}) {
            INFO(to_string(kind) << " on a " << scene.name);
            DroppedSheet s(0.2, 0.02, {0, 0.01, 0}, scene.body, kind);
            int unresolved = 0, met = 0;
            for (int i = 0; i < 300; ++i) {
                const ResponseDone done = s.step_on();
                unresolved += done.unresolved;
                met += done.impulses + done.zones + done.repulsions > 0 || !s.cloth.touches.empty();
                if (i % 10 != 9) continue;
                const IntersectionCount n = s.crossings(scene.body.triangles);
                REQUIRE(n.cloth_avatar + n.cloth_cloth == 0);
            }
            CHECK(unresolved == 0);
            CHECK(met > 30);
        }
}

TEST_CASE("penalty and constraint do not keep cloth off a needle", "[responses]") {
    const TriMesh needle = spike({0.003, 0, 0.002}, 0.1, 0.002);
    for (const ContactResponse kind : {ContactResponse::penalty, ContactResponse::constraint}) {
        INFO(to_string(kind));
        DroppedSheet s(0.2, 0.02, {0, 0.01, 0}, needle, kind);
        for (int i = 0; i < 60; ++i) s.step_on();
        CHECK(s.crossings(needle.triangles).cloth_avatar > 0);
    }
}

TEST_CASE("a body that moves lifts the cloth that it meets", "[responses]") {
    TriMesh plate = box(Vec3(-0.15, -0.02, -0.15), Vec3(0.15, 0, 0.15));
    for (const ContactResponse kind : {ContactResponse::impulse, ContactResponse::rigid, ContactResponse::constraint}) {
        INFO(to_string(kind));
        TriMesh body = plate;
        DroppedSheet s(0.15, 0.02, {0, 0.002, 0}, body, kind);
        int unresolved = 0;
        for (int i = 0; i < 200; ++i) {
            body = moved(body, s.options.time_step * Vec3(0.1, 0.5, 0));
            unresolved += s.step_on(body.points).unresolved;
        }
        CHECK(unresolved == 0);
        CHECK(s.crossings(body.triangles).cloth_avatar == 0);
        Vec3 mean = Vec3::Zero();
        for (const Vec3& v : s.cloth.velocity) mean += v / double(s.cloth.velocity.size());
        CHECK((mean - Vec3(0.1, 0.5, 0)).norm() < 0.02);
        CHECK(s.response->body()[0] == body.points[0]);
    }
}
