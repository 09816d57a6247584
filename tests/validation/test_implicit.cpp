// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth in motion: what implicit Euler with a response is to come to.

#include "draping/solve/settle.h"
#include "tests/support/dropped_sheet.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double g = 9.81;

double weight(const ClothProblem& problem) {
    double sum = 0;
    for (const double m : problem.node_mass()) sum += g * m;
    return sum;
}

TriMesh moved(TriMesh mesh, const Vec3& by) {
    for (Vec3& p : mesh.points) p += by;
    return mesh;
}

/// A sheet that lies flat on a board tilted by `angle` and is let go.
std::unique_ptr<DroppedSheet> on_slope(double angle, ContactResponse kind, double friction) {
    TriMesh board = box(Vec3(-0.5, -0.1, -0.5), Vec3(0.5, 0, 0.5));
    const Mat3 turn = Eigen::AngleAxisd(-angle, Vec3::UnitZ()).toRotationMatrix();
    for (Vec3& p : board.points) p = turn * p;
    ResponseOptions o;
    o.body_friction = friction;
    auto s = std::make_unique<DroppedSheet>(0.1, 0.02, Vec3(0, o.thickness, 0), board, kind, o);
    for (Vec3& p : s->cloth.x) p = turn * p;
    return s;
}

} // namespace

TEST_CASE("steps: free fall, and air that takes its share", "[responses]") {
    DroppedSheet s(0.1, 0.02, {0, 0, 0}, {}, ContactResponse::impulse);
    for (int i = 0; i < 50; ++i) s.step_on();
    for (const Vec3& v : s.cloth.velocity) CHECK((v - Vec3(0, -50 * s.options.time_step * g, 0)).norm() < 1e-9);
    CHECK(kinetic_energy(s.problem.node_mass(), s.cloth) ==
          Approx(0.5 * weight(s.problem) / g * std::pow(50 * s.options.time_step * g, 2)));
    s.options.damping = 20;
    for (int i = 0; i < 500; ++i) s.step_on();
    for (const Vec3& v : s.cloth.velocity) CHECK((v - Vec3(0, -g / 20, 0)).norm() < 1e-6);
}

TEST_CASE("steps: cloth comes to rest where it is in balance", "[responses]") {
    DroppedSheet s(0.2, 0.02, {0, 0, 0}, {}, ContactResponse::impulse);
    for (int i = 0; i < s.problem.points(); ++i)
        if (s.cloth.x[i].x() == -0.1) s.problem.pin(i);
    Points settled = s.cloth.x;
    RestOptions o;
    s.options.damping = 5;
    s.options.max_motion = 0.1;
    const RestResult r = come_to_rest(s.stepper, s.cloth, s.response->body(), o);
    CHECK(r.rested);
    CHECK(r.residual <= 1e-3);
    SettleOptions still;
    Cholesky factor;
    REQUIRE(settle(s.problem, settled, factor, still).end == SettleEnd::settled);
    for (std::size_t i = 0; i < settled.size(); ++i) CHECK((settled[i] - s.cloth.x[i]).norm() < 1e-3);
}

TEST_CASE("steps: on a sphere the forces of contact bear the weight", "[responses]") {
    const TriMesh ball = moved(sphere(0.1, 3), Vec3(0, -0.1, 0));
    for (const ContactResponse kind : {ContactResponse::constraint, ContactResponse::impulse, ContactResponse::rigid}) {
        INFO(to_string(kind));
        DroppedSheet s(0.2, 0.02, {0, 0.002, 0}, ball, kind);
        RestOptions o;
        s.options.damping = 10;
        o.max_steps = 2000;
        const RestResult r = come_to_rest(s.stepper, s.cloth, s.response->body(), o);
        CHECK(r.rested);
        CHECK(r.residual <= 1e-3);
        Vec3 force = Vec3::Zero();
        for (const Vec3& f : s.cloth.contact_force()) force += f;
        CHECK((force - Vec3(0, weight(s.problem), 0)).norm() < 0.05 * weight(s.problem));
        CHECK(r.unresolved == 0);
    }
}

TEST_CASE("steps: a sheet slides on a slope from the angle of friction on", "[responses]") {
    const double angle = 0.4, limit = std::tan(angle);
    for (const ContactResponse kind : {ContactResponse::constraint, ContactResponse::impulse})
        for (const double share : {0.5, 0.9, 0.95, 1.02, 1.1}) {
            INFO(to_string(kind) << " with " << share << " of what holds");
            const auto sheet = on_slope(angle, kind, share * limit);
            DroppedSheet& s = *sheet;
            for (int i = 0; i < 400; ++i) s.step_on();
            const Vec3 down(std::cos(angle), -std::sin(angle), 0);
            double speed = 0;
            for (const Vec3& v : s.cloth.velocity) speed += v.dot(down) / double(s.cloth.velocity.size());
            const double expected = g * (std::sin(angle) - share * limit * std::cos(angle)) * 400 * s.options.time_step;
            if (share > 1) {
                CHECK(speed < 1e-6);
            } else { // friction lags by a step, which tells while the sheet starts
                CHECK(speed > 0.5 * expected);
                CHECK(speed < 1.1 * expected);
            }
        }
}
