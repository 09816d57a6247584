// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fabric/stretch_curve.h"

#include "draping/energy/stretch.h"
#include "draping/energy/triangles.h"
#include "tests/support/energy_checks.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace toile;
using namespace toile::test;
using Catch::Matchers::Contains;

namespace {

/// Soft, then stiff, then softer again, with a kink that a cubic through the points alone would overshoot.
const std::vector<StretchPoint> uneven{{0, 0}, {0.01, 1}, {0.03, 2}, {0.08, 20}, {0.2, 80}, {0.3, 100}};

Fabric knit() {
    Fabric f;
    f.name = "knit";
    f.poisson = 0.25;
    f.shear = 40;
    f.compression = 0.4;
    f.bend_warp = f.bend_weft = 1e-5;
    f.bend_twist = 5e-6;
    set_warp_curve(f, {{0, 0}, {0.01, 3}, {0.02, 7}, {0.04, 18}, {0.08, 40}});
    set_weft_curve(f, {{0, 0}, {0.015, 2}, {0.05, 8}, {0.2, 60}});
    return f;
}

/// Points of a membrane of constant stiffness.
std::vector<StretchPoint> straight(double k) {
    std::vector<StretchPoint> points;
    for (const double s : {0.0, 0.013, 0.05, 0.11, 0.3}) points.push_back({s, (1 + s) * k * s * (1 + s / 2)});
    return points;
}

void check_same(const TestedEnergy& a, const TestedEnergy& b, const Points& x) {
    CHECK(a.value(x) == Approx(b.value(x)).epsilon(1e-12));
    const Eigen::VectorXd g = gradient_of(b, x);
    CHECK((gradient_of(a, x) - g).norm() < 1e-12 * g.norm());
    for (const HessianKind kind : {HessianKind::exact, HessianKind::projected}) {
        const Eigen::MatrixXd h = b.hessian(x, kind);
        CHECK((a.hessian(x, kind) - h).norm() < 1e-12 * h.norm());
    }
}

} // namespace

TEST_CASE("stretch curve: through its points, monotone, straight beyond them", "[stretch_curve]") {
    const StretchCurve curve = stretch_curve(uneven);
    for (const StretchPoint& p : uneven) CHECK(evaluate(curve, p.stretch).tension == Approx(p.tension).epsilon(1e-12));
    double before = 0;
    for (double s = 1e-4; s < 0.5; s += 1e-4) {
        const CurveState at = evaluate(curve, s);
        CHECK(at.tension > before);
        CHECK(at.slope >= least_slope(curve) - 1e-9);
        before = at.tension;
    }
    CHECK(least_slope(curve) > 0);
    CHECK(evaluate(curve, 0.7).tension == Approx(100 + 0.4 * 200));
    CHECK(evaluate(curve, -0.1).tension == Approx(-10));
    CHECK(evaluate(curve, -0.1).energy == Approx(0.5));
    // The least slope is the least there is: within a piece, below both of its ends.
    const StretchCurve wave = stretch_curve({{0, 0}, {1, 10}, {2, 11}, {3, 21}});
    double least = 1e9;
    for (double s = 0; s < 3; s += 1e-4) least = std::min(least, evaluate(wave, s).slope);
    CHECK(least_slope(wave) == Approx(least).epsilon(1e-3));
    CHECK(least_slope(wave) >= 0.5); // half the least secant
}

TEST_CASE("stretch curve: energy and slope are the integral and the derivative, and both continuous", "[stretch_curve]") {
    const StretchCurve curve = stretch_curve(uneven);
    const double h = 1e-6;
    double sum = 0;
    for (double s = 0; s < 0.4; s += 0.003) {
        const CurveState low = evaluate(curve, s + h), high = evaluate(curve, s + 3 * h), at = evaluate(curve, s + 2 * h);
        CHECK((high.energy - low.energy) / (2 * h) == Approx(at.tension).epsilon(1e-7).margin(1e-8));
        CHECK((high.tension - low.tension) / (2 * h) == Approx(at.slope).epsilon(1e-4));
        for (int k = 0; k < 300; ++k) sum += evaluate(curve, s + (k + 0.5) * 1e-5).tension * 1e-5;
        CHECK(evaluate(curve, s + 0.003).energy == Approx(sum).epsilon(1e-6));
    }
    for (const StretchPoint& p : uneven) {
        const CurveState low = evaluate(curve, p.stretch - 1e-12), high = evaluate(curve, p.stretch + 1e-12);
        CHECK(std::abs(low.tension - high.tension) < 1e-8);
        CHECK(std::abs(low.slope - high.slope) < 1e-5);
    }
}

TEST_CASE("stretch curve: as shares of a straight line's", "[stretch_curve]") {
    const StretchCurve curve = stretch_curve(uneven);
    for (const double s : {1e-5, 5e-3, 0.00999, 0.01001, 0.15, 0.6}) {
        const CurveState at = evaluate(curve, s);
        const CurveSecants by = secants(curve, s);
        CHECK(0.5 * by.by_energy * s * s == Approx(at.energy).epsilon(1e-10));
        CHECK(by.by_tension * s == Approx(at.tension).epsilon(1e-12));
        CHECK(by.slope == at.slope);
    }
    for (const double s : {-0.2, 0.0, 1e-300}) {
        CHECK(secants(curve, s).by_energy == Approx(100));
        CHECK(secants(curve, s).by_tension == Approx(100));
    }
}

TEST_CASE("stretch curve: what is none is refused in a sentence", "[stretch_curve]") {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    CHECK_THROWS_WITH(check_points({{0, 0}}),
                      "a stretch curve has 1 points: expected 2 to 1000 of stretch and tension (N/m)");
    CHECK_THROWS_WITH(check_points({{0.01, 0}, {0.1, 3}}), "a stretch curve begins at (0.01, 0): expected (0, 0)");
    CHECK_THROWS_WITH(check_points({{0, 0}, {0.1, 3}, {0.1, 4}}),
                      "point 2 of a stretch curve, (0.1, 4), follows (0.1, 3): expected both stretch and tension to rise");
    CHECK_THROWS_WITH(check_points({{0, 0}, {0.1, 3}, {0.2, 3}}), Contains("expected both stretch and tension to rise"));
    CHECK_THROWS_WITH(check_points({{0, 0}, {nan, 3}}), Contains("point 1 of a stretch curve is not finite"));
    CHECK_THROWS_WITH(check_points({{0, 0}, {0.1, inf}}), Contains("is not finite"));
    Fabric f = knit();
    CHECK_THROWS_WITH(set_warp_curve(f, {{0, 0}, {0.1, 3}, {0.5, 3.1}}), Contains("expected tension / (1 + stretch) to rise"));
    // What a membrane with this Poisson ratio does not bear, names the fabric.
    set_warp_curve(f, {{0, 0}, {0.05, 15}, {0.1, 17}, {0.2, 21}});
    set_weft_curve(f, {{0, 0}, {0.05, 10}, {0.1, 11}, {0.2, 13}});
    CHECK_THROWS_WITH(make_stretch(garment_of(jittered_rectangle(0.1, 0.1, 0.05, 0.2, 1)), {f}),
                      Contains("fabric \"knit\": its stretch curves become too flat for a Poisson ratio of 0.25"));
    f.poisson = 0.02;
    CHECK_NOTHROW(make_stretch(garment_of(jittered_rectangle(0.1, 0.1, 0.05, 0.2, 1)), {f}));
}

TEST_CASE("stretch curve: derivatives of membrane and triangles between and beyond its points", "[stretch_curve]") {
    const FlatMesh mesh = jittered_rectangle(0.3, 0.2, 0.05, 0.3, 5);
    const Garment g = garment_of(mesh, 0.3);
    Fabric half = knit();
    half.curve_weft.clear();
    for (const Fabric& f : {knit(), half}) {
        std::vector<TestedState> states = tested_states(mesh);
        // By random shares of what the curves reach, and beyond; pieces differ from triangle to triangle.
        for (const double most : {0.01, 0.03, 0.1, 0.3}) {
            Random random(static_cast<std::uint64_t>(1e4 * most));
            Points x;
            for (const Vec2& p : mesh.points)
                x.push_back(Vec3((1 + most * random.in(0, 1)) * p.x() + 0.05 * p.y(), (1 + most) * p.y(), 0) +
                            random.vec3(0.02 * most));
            states.push_back({"stretched by up to " + std::to_string(most), x, 1e-7});
        }
        for (TestedState state : states) {
            check_energy({stretch_energy("stretch", make_stretch(g, {f})), state});
            if (state.name == "collapsed") state.step = 5e-11;
            check_energy({model_energy("triangles", std::make_shared<TriangleCloth>(g, std::vector<Fabric>{f})), state});
        }
    }
}

TEST_CASE("stretch curve: the membrane passes a point without a jump", "[stretch_curve]") {
    const StretchElement e = make_stretch(garment_of(jittered_rectangle(0.1, 0.1, 0.05, 0.2, 1)), {knit()}).front();
    for (const double s : {0.01, 0.02, 0.04, 0.08}) {
        const auto at = [&](double off) { return stretch_response(e, Vec3(0.02, s * (1 + s / 2) + off, 0.01)); };
        CHECK((at(1e-12).stress - at(-1e-12).stress).norm() < 1e-8);
        CHECK((at(1e-12).tangent - at(-1e-12).tangent).norm() < 1e-5);
        CHECK((at(1e-4).tangent - at(-1e-4).tangent).norm() > 1e-3); // or there was nothing to pass
    }
}

TEST_CASE("stretch curve: a straight one is constant stiffness", "[stretch_curve]") {
    const FlatMesh mesh = jittered_rectangle(0.3, 0.2, 0.05, 0.3, 5);
    const Garment g = garment_of(mesh, 0.3);
    Fabric constant = knit(), curved = constant;
    constant.curve_warp.clear();
    constant.curve_weft.clear();
    constant.stretch_warp = 300;
    constant.stretch_weft = 170;
    set_warp_curve(curved, straight(300));
    set_weft_curve(curved, straight(170));
    for (const TestedState& state : tested_states(mesh))
        check_same(stretch_energy("curved", make_stretch(g, {curved})), stretch_energy("constant", make_stretch(g, {constant})),
                   state.x);
    constant.limit_warp = curved.limit_warp = 0.02;
    constant.limit_weft = curved.limit_weft = 0.03;
    CHECK(make_strain_limits(g, {curved})[3].warp_stiffness ==
          Approx(make_strain_limits(g, {constant})[3].warp_stiffness).epsilon(1e-12));
    // By engineering strain, triangles are straight where tension is.
    set_warp_curve(curved, {{0, 0}, {0.02, 6}, {0.2, 60}});
    set_weft_curve(curved, {{0, 0}, {0.05, 8.5}, {0.1, 17}});
    for (const TestedState& state : tested_states(mesh))
        check_same(model_energy("curved", std::make_shared<TriangleCloth>(g, std::vector<Fabric>{curved})),
                   model_energy("constant", std::make_shared<TriangleCloth>(g, std::vector<Fabric>{constant})), state.x);
}

TEST_CASE("stretch curve: the force of a constraint is that of the curve", "[stretch_curve]") {
    const FlatMesh mesh = jittered_rectangle(0.3, 0.2, 0.05, 0.3, 5);
    const Garment g = garment_of(mesh, 0.3);
    const TriangleCloth cloth(g, {knit()});
    for (const TestedState& state : tested_states(mesh)) {
        if (state.name == "collapsed") continue;
        Eigen::VectorXd all = Eigen::VectorXd::Zero(3 * state.x.size()), given = all;
        cloth.add_gradient(state.x, all);
        for (int k = 0; k < cloth.constraint_count(); ++k) {
            const Constraint c = cloth.constraint(k, state.x);
            for (int i = 0; i < c.count; ++i)
                given.segment<3>(3 * c.nodes[i]) += c.stiffness * c.value * c.gradient[i];
        }
        CHECK((given - all).norm() < 1e-10 * all.norm());
    }
}
