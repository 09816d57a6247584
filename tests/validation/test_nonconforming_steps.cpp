// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth on edge midpoints as a method that moves: in the air, held, on a body, from wrong lengths.

#include "draping/cloth.h"
#include "draping/method.h"
#include "draping/solve/nonconforming.h"
#include "tests/support/flat_mesh.h"
#include "tests/support/plain_fabric.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double g = 9.81;

/// A level sheet of 20 cm, `stretched` along x, its middle 2 mm above the origin; a body below or none.
struct FallingSheet {
    FlatMesh mesh = jittered_rectangle(0.2, 0.2, 0.02, 0.25, 7);
    Garment garment = garment_of(mesh);
    TriMesh body;
    std::unique_ptr<Response> response;
    std::unique_ptr<Stepper> stepper;
    Moving cloth;
    std::vector<double> mass = node_masses(garment, {plain_fabric(1000, 1e-5)});

    explicit FallingSheet(bool held, const TriMesh& on = {}, ContactResponse kind = ContactResponse::impulse, double stretched = 1)
        : body(on), response(make_response(kind, contact_cloth(garment), body, {})) {
        std::vector<char> pinned;
        for (const Vec2& p : mesh.points) {
            pinned.push_back(held && p.x() < 1e-9);
            cloth.x.push_back({stretched * (p.x() - 0.1), 0.002, 0.1 - p.y()});
        }
        stepper = make_stepper(Method::nonconforming, garment, {plain_fabric(1000, 1e-5)}, pinned, *response,
                               {2e-3, 10, 5e-3}, {});
        stepper->loads().gravity = g;
    }
    const Motion& motion() const { return dynamic_cast<NonconformingStepper&>(*stepper).motion(); }
    double weight() const {
        double sum = 0;
        for (const double m : mass) sum += g * m;
        return sum;
    }
    Vec3 momentum_of_nodes() const {
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = 0; i < mass.size(); ++i) sum += mass[i] * cloth.velocity[i];
        return sum;
    }
    RestResult rest(int most) {
        RestOptions o;
        o.max_steps = most;
        return come_to_rest(*stepper, cloth, response->body(), o);
    }
    IntersectionCount crossings() const {
        return count_intersections(node_triangles(garment), cloth.x, {response->body(), body.triangles});
    }
};

TriMesh ball() {
    TriMesh mesh = sphere(0.1, 3);
    for (Vec3& p : mesh.points) p.y() -= 0.1;
    return mesh;
}

} // namespace

TEST_CASE("cloth on midpoints falls freely, and air takes its share", "[nonconforming]") {
    FallingSheet s(false);
    s.stepper->options() = {2e-3, 0, 1};
    for (int i = 0; i < 50; ++i) s.stepper->step(s.cloth, {});
    for (const Vec3& v : s.cloth.velocity) CHECK((v - Vec3(0, -50 * 2e-3 * g, 0)).norm() < 1e-8);
    s.stepper->options().damping = 20;
    for (int i = 0; i < 500; ++i) s.stepper->step(s.cloth, {});
    for (const Vec3& v : s.cloth.velocity) CHECK((v - Vec3(0, -g / 20, 0)).norm() < 1e-6);
}

TEST_CASE("in free flight bent and spinning cloth on midpoints keeps its momentum, and its nodes have it", "[nonconforming]") {
    FallingSheet s(false);
    s.stepper->options() = {2e-3, 0, 1};
    s.stepper->loads().gravity = 0;
    for (const Vec3& p : s.cloth.x) s.cloth.velocity.push_back({1, 2 + 3 * p.x() + 0.2 * std::sin(20 * p.z()), 0});
    const Vec3 before = s.momentum_of_nodes();
    for (int i = 0; i < 100; ++i) {
        s.stepper->step(s.cloth, {});
        CHECK((s.momentum_of_nodes() - before).norm() < 1e-11 * before.norm());
        CHECK((momentum(s.motion()) - before).norm() < 1e-11 * before.norm());
        CHECK(*s.stepper->kept_strain() < 1e-6);
    }
}

TEST_CASE("cloth on midpoints gains the momentum that contact gives its nodes", "[nonconforming]") {
    FallingSheet s(false, ball());
    bool touched = false;
    for (int i = 0; i < 60; ++i) {
        s.stepper->step(s.cloth, s.response->body());
        const Vec3 nodes = s.momentum_of_nodes();
        CHECK((momentum(s.motion()) - nodes).norm() < 1e-10 * (nodes.norm() + 1e-3));
        for (const Vec3& f : s.cloth.contact_force()) touched = touched || f.norm() > 0;
    }
    CHECK(touched);
}

TEST_CASE("cloth on midpoints held at one side comes to rest with its lengths", "[nonconforming]") {
    FallingSheet s(true);
    const Points start = s.cloth.x;
    const RestResult r = s.rest(1500);
    INFO("residual " << r.residual << ", " << r.speed << " m/s after " << r.steps << " steps");
    CHECK(r.rested);
    CHECK(*s.stepper->kept_strain() < 1e-6);
    double low = 0;
    for (std::size_t i = 0; i < start.size(); ++i) {
        if (start[i].x() < -0.1 + 1e-9) CHECK((s.cloth.x[i] - start[i]).norm() < 1e-9);
        low = std::min(low, s.cloth.x[i].y());
    }
    CHECK(low < -0.19); // it hangs down, and is no longer than it was
    CHECK(low > -0.2 + 0.002 - 1e-3);
}

TEST_CASE("cloth on midpoints rests on a sphere with its lengths and without crossing it", "[nonconforming]") {
    for (const ContactResponse kind : {ContactResponse::impulse, ContactResponse::constraint}) {
        INFO(to_string(kind));
        const TriMesh on = ball();
        FallingSheet s(false, on, kind);
        const RestResult r = s.rest(1500);
        INFO("residual " << r.residual << ", " << r.speed << " m/s after " << r.steps << " steps");
        CHECK(r.rested);
        CHECK(r.unresolved == 0);
        CHECK(*s.stepper->kept_strain() < 1e-6);
        if (s.response->guarantee() == Guarantee::no_crossing) CHECK(s.crossings().cloth_avatar == 0);
        CHECK(s.crossings().cloth_cloth == 0);
        Vec3 force = Vec3::Zero();
        for (const Vec3& f : s.cloth.contact_force()) force += f;
        CHECK((force - Vec3(0, s.weight(), 0)).norm() < 0.01 * s.weight());
    }
}

TEST_CASE("cloth that starts with wrong lengths is drawn in by a bounded share of them a step", "[nonconforming]") {
    FallingSheet s(false, {}, ContactResponse::impulse, 1.1);
    s.stepper->loads().gravity = 0;
    s.stepper->step(s.cloth, {});
    double last = largest_strain(s.motion().cloth.bars, s.motion().x);
    CHECK(last > 0.098);
    for (int i = 0; i < 150; ++i) {
        s.stepper->step(s.cloth, {});
        const double now = largest_strain(s.motion().cloth.bars, s.motion().x);
        CHECK(now > last - 1.01e-3);
        last = now;
    }
    CHECK(*s.stepper->kept_strain() < 1e-6);
}

TEST_CASE("hooks carry cloth on midpoints with its weight", "[nonconforming]") {
    FallingSheet s(false);
    const Points start = s.cloth.x;
    for (std::size_t i = 0; i < start.size(); ++i)
        if (start[i].x() < -0.1 + 1e-9) s.stepper->loads().hooks.push_back({int(i), start[i], Vec3::Ones(), 1000, 1});
    const RestResult r = s.rest(1500);
    INFO("residual " << r.residual << ", " << r.speed << " m/s after " << r.steps << " steps");
    CHECK(r.rested);
    CHECK(*s.stepper->kept_strain() < 1e-6);
    double carried = 0;
    for (const HookSpring& h : s.stepper->loads().hooks) carried += 1000 * (h.place - s.cloth.x[h.node]).y();
    CHECK(carried == Approx(s.weight()).epsilon(1e-3));
}
