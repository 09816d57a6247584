// SPDX-License-Identifier: GPL-3.0-or-later
// The barrier with every method: rest, and nothing crossed on the way there.

#include "draping/cloth.h"
#include "draping/energy/yarns.h"
#include "draping/method.h"
#include "draping/settle_cloth.h"
#include "draping/solve/barrier_response.h"
#include "draping/solve/settle.h"
#include "draping/solve/stepper.h"
#include "tests/support/flat_mesh.h"
#include "tests/support/particles.h"
#include "tests/support/plain_fabric.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numeric>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double g = 9.81;
constexpr double tolerance = 1e-3;
constexpr FrictionCoefficients rough{0.3, 0.3};

TriMesh moved(TriMesh mesh, const Vec3& by) {
    for (Vec3& p : mesh.points) p += by;
    return mesh;
}

/// A square of 20 cm, cut along its yarns, above a ball.
struct SheetOnBall {
    Garment garment = garment_of(halved_squares(10, 10, 0.02));
    std::vector<Fabric> fabrics{plain_fabric(500, 1e-5)};
    TriMesh ball = moved(sphere(0.15, 3), Vec3(0, -0.15, 0));
    Points x;
    ContactOptions contact = barriers_at(0.5e-3, fabrics[0].density);

    SheetOnBall() {
        for (const Vec2& p : garment.uv) x.push_back({p.x() - 0.1, 0.002, 0.1 - p.y()});
    }
    double weight() const {
        const std::vector<double> mass = node_masses(garment, fabrics);
        return g * std::accumulate(mass.begin(), mass.end(), 0.0);
    }
    int crossings() const {
        const IntersectionCount n = count_intersections(node_triangles(garment), x, ball);
        return n.cloth_avatar + n.cloth_cloth;
    }
    /// All of the cloth is round the ball, and some of it hangs.
    bool lies() const {
        double low = 0, high = -1;
        for (const Vec3& p : x) {
            low = std::min(low, p.y());
            high = std::max(high, p.y());
        }
        return high > 0 && high < 1e-3 && low < -0.02;
    }
};

ResponseOptions friction() {
    ResponseOptions o;
    o.body_friction = rough.body;
    o.cloth_friction = rough.cloth;
    return o;
}

/// A triangle on a floor tilted by `angle`.
struct TriangleOnSlope {
    Vec3 up, down;
    TriMesh slope = floor_face();
    Particles cloth{{}, {}, 1};

    explicit TriangleOnSlope(double angle) {
        const Mat3 turn = Eigen::AngleAxisd(-angle, Vec3::UnitZ()).toRotationMatrix();
        up = turn * Vec3::UnitY();
        down = turn * Vec3::UnitX();
        for (Vec3& p : slope.points) p = turn * p;
        Points x = level_triangle(0.4e-3);
        for (Vec3& p : x) p = turn * p;
        cloth = Particles(x, {{0, 2, 1}}, 1e-4);
    }
};

} // namespace

TEST_CASE("barrier: methods that settle come to rest on a ball and cross nothing", "[validation][barrier]") {
    for (const Method method : all_methods()) {
        if (!settles(method)) continue;
        INFO(to_string(method));
        SheetOnBall s;
        ClothProblem problem(make_energy(method, s.garment, s.fabrics, {}), s.garment, s.fabrics, s.ball, s.contact);
        problem.gravity = g;
        problem.rest_here(s.x, rough);
        SettleOptions o;
        o.tolerance = tolerance;
        o.max_iterations = 1000;
        bool crossed = false;
        o.progress = [&](int, double) { return !(crossed = crossed || s.crossings() > 0); };
        Cholesky factor;
        const SettleResult r =
            settle_constrained(problem, s.x, o, [&](const SettleOptions& some) { return settle_cloth(problem, s.x, factor, some); });
        CHECK(r.end == SettleEnd::settled);
        CHECK(r.residual <= tolerance);
        CHECK_FALSE(problem.take_up(problem.all_points(s.x)));
        CHECK_FALSE(crossed);
        CHECK(s.lies());
    }
}

TEST_CASE("barrier: yarns that settle keep their lengths", "[validation][barrier]") {
    SheetOnBall s;
    const auto lines = yarn_edges(s.garment);
    ClothProblem problem(make_energy(Method::inextensible, s.garment, s.fabrics, {}), s.garment, s.fabrics, s.ball, s.contact);
    problem.gravity = g;
    problem.rest_here(s.x, rough);
    SettleOptions o;
    o.max_iterations = 1000;
    Cholesky factor;
    const auto longest = [&] {
        double most = 0;
        for (const LengthConstraint& c : lines) most = std::max(most, std::abs(strain(c, s.x)));
        return most;
    };
    REQUIRE(settle(problem, s.x, factor, o).end == SettleEnd::settled);
    CHECK(longest() > 10 * Tension::kept); // springs alone do not
    while (problem.take_up(s.x)) REQUIRE(settle(problem, s.x, factor, o).end == SettleEnd::settled);
    CHECK(longest() < 1.1 * Tension::kept);
}

TEST_CASE("barrier: methods that step come to rest on a ball and cross nothing", "[validation][barrier]") {
    for (const Method method : {Method::springs_explicit, Method::springs_limited, Method::xpbd, Method::springs_implicit}) {
        INFO(to_string(method));
        SheetOnBall s;
        const auto response = barrier_response(contact_cloth(s.garment), s.ball, s.contact, friction());
        const auto stepper = make_stepper(method, s.garment, s.fabrics, std::vector<char>(s.x.size(), 0), *response,
                                          {5e-4, 10, 5e-3}, {});
        stepper->loads().gravity = g;
        Moving cloth{s.x};
        RestOptions o;
        o.tolerance = tolerance;
        o.max_steps = 8000;
        bool crossed = false;
        o.progress = [&](int step, double) {
            s.x = cloth.x;
            if (step % 20 == 0) crossed = crossed || s.crossings() > 0;
            return true;
        };
        const RestResult r = come_to_rest(*stepper, cloth, s.ball.points, o);
        INFO("residual " << r.residual << ", " << r.speed << " m/s after " << r.steps << " steps");
        CHECK(r.rested);
        CHECK(r.residual <= tolerance);
        CHECK(r.unresolved == 0);
        CHECK_FALSE(crossed);
        CHECK(s.crossings() == 0);
        CHECK(s.lies());
        Vec3 force = Vec3::Zero();
        for (const Vec3& f : cloth.contact_force()) force += f;
        CHECK((force - Vec3(0, s.weight(), 0)).norm() < 2e-3 * s.weight());
    }
}

TEST_CASE("barrier: a proximal step is where its forces are in balance with inertia", "[barrier]") {
    Particles p = stacked_sheets(3, 3, 0.02, 0.3e-3, 0.3e-3, 1e-4);
    for (int i = 0; i < int(p.x.size()); ++i) p.x[i] += 0.003 * (i / 16) * Vec3(1, 0, 0.7) + 1e-5 * ((7 * i) % 5) * Vec3::UnitY();
    const ContactOptions contact = barriers_at(0.5e-3, 0.15);
    const auto response = barrier_response(p.cloth, floor_face(), contact, friction());
    const double dt = 1e-3;
    Points start = p.x, candidate(p.v.size(), Vec3(0.05, -0.5, 0));
    p.v = candidate;
    const ResponseDone done = response->respond({dt, p.x, start, p.inverse_mass, response->body()}, p.v);
    double pressed = 0;
    for (std::size_t i = 0; i < p.v.size(); ++i) {
        const Vec3 inertia = (p.v[i] - candidate[i]) / (dt * p.inverse_mass[i]);
        CHECK((inertia - done.other_force[i]).norm() < 1e-3 * g / p.inverse_mass[i]);
        pressed += done.other_force[i].y();
        CHECK(start[i].y() + dt * p.v[i].y() > contact.body.floor);
    }
    CHECK(pressed > 0.1 * double(p.v.size()) * 0.5 / (dt * p.inverse_mass[0])); // much of the momentum
}

TEST_CASE("barrier: what lies on a slope slides from the angle of friction on", "[barrier]") {
    const double angle = 0.4;
    for (const double share : {0.9, 1.2}) {
        TriangleOnSlope s(angle);
        ResponseOptions o;
        o.body_friction = share * std::tan(angle);
        const auto response = barrier_response(s.cloth.cloth, s.slope, barriers_at(0.5e-3, 0.15), o);
        const Points start = s.cloth.x;
        const double dt = 5e-4;
        const int steps = 1000;
        Points halfway;
        for (int k = 0; k < steps; ++k) {
            if (2 * k == steps) halfway = s.cloth.x;
            s.cloth.step(*response, dt);
        }
        const double speed = s.cloth.v[0].dot(s.down);
        const double expected = g * (std::sin(angle) - share * std::tan(angle) * std::cos(angle)) * steps * dt;
        if (share > 1) {
            CHECK((s.cloth.x[0] - start[0]).norm() < 5e-3); // while friction grew to what it is
            CHECK((s.cloth.x[0] - halfway[0]).norm() < 2e-4); // two slips: ties are springs
        } else {
            CHECK(speed > 0.9 * expected);
            CHECK(speed < 1.5 * expected); // what has gone up and down keeps 95 % of its friction
        }
    }
}

TEST_CASE("barrier: a body that rises takes cloth along and crosses nothing", "[barrier]") {
    const Garment garment = garment_of(halved_squares(4, 4, 0.02));
    Particles p{Points(garment.node_count), node_triangles(garment), 1e-4};
    for (int i = 0; i < garment.node_count; ++i) p.x[i] = {garment.uv[i].x() - 0.04, 1e-3, garment.uv[i].y() - 0.04};
    p = Particles(p.x, node_triangles(garment), 1e-4);
    TriMesh block = box(Vec3(-0.1, -0.1, -0.1), Vec3(0.1, 0, 0.1));
    const auto response = barrier_response(p.cloth, block, barriers_at(0.5e-3, 0.15), friction());
    const double dt = 2e-3, speed = 2;
    for (int k = 0; k < 50; ++k) {
        const TriMesh next = moved(block, Vec3(0, dt * speed, 0));
        CHECK(p.step(*response, dt, next.points).unresolved == 0);
        block.points = next.points;
        REQUIRE(count_intersections(p.cloth.triangles, p.x, block).cloth_avatar == 0);
    }
    for (const Vec3& x : p.x) CHECK(x.y() > block.points[6].y());
}
