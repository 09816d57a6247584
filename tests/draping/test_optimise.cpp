// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fit/optimise.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace toile;
using Eigen::VectorXd;

namespace {

/// (x - 1)^2 + 10 (y - x^2)^2 within [-2, 2].
OptimiseProblem valley() {
    OptimiseProblem p;
    p.start = VectorXd::Constant(2, -1);
    p.low = VectorXd::Constant(2, -2);
    p.high = VectorXd::Constant(2, 2);
    p.value = [](const VectorXd& v, VectorXd* g) {
        const double a = v[0] - 1, b = v[1] - v[0] * v[0];
        if (g) *g = Eigen::Vector2d(2 * a - 40 * v[0] * b, 20 * b);
        return a * a + 10 * b * b;
    };
    return p;
}

/// x + y = sum.
Equality sum_is(double sum) {
    return {"the sum", [sum](const VectorXd& v, VectorXd* g) {
                if (g) *g = VectorXd::Ones(2);
                return v.sum() - sum;
            }};
}

OptimiseOptions by(Optimiser optimiser) {
    OptimiseOptions o;
    o.optimiser = optimiser;
    o.max_evaluations = 5000;
    o.value_tolerance = 1e-10;
    o.step_tolerance = 1e-6;
    return o;
}

} // namespace

TEST_CASE("every optimiser finds the end of a bent valley, and a bound in the way") {
    for (const Optimiser optimiser : {Optimiser::slsqp, Optimiser::lbfgs, Optimiser::cobyla}) {
        INFO(to_string(optimiser));
        OptimiseProblem p = valley();
        OptimiseResult r = optimise(p, by(optimiser));
        CHECK(r.end == OptimiseEnd::least);
        CHECK((r.at - VectorXd::Ones(2)).norm() < 1e-3);
        p.high[0] = 0.5;
        r = optimise(p, by(optimiser));
        CHECK(r.at[0] == Approx(0.5));
        CHECK(r.at[1] == Approx(0.25).margin(1e-3));
    }
}

TEST_CASE("with its curvature a long valley is round, and its bounds hold") {
    Eigen::Matrix2d curvature;
    curvature << 2000, 1980, 1980, 2000; // 100 to 1, aslant
    OptimiseProblem p = valley();
    p.value = [curvature](const VectorXd& v, VectorXd* g) {
        const VectorXd off = v - Eigen::Vector2d(1, -0.5);
        if (g) *g = curvature * off;
        return 0.5 * off.dot(curvature * off);
    };
    OptimiseOptions o = by(Optimiser::slsqp);
    p.curvature = curvature;
    OptimiseResult r = optimise(p, o);
    CHECK(r.evaluations <= 4);
    CHECK((r.at - Eigen::Vector2d(1, -0.5)).norm() < 1e-6);
    p.high[0] = 0.5; // the other follows it along the valley
    r = optimise(p, o);
    CHECK(r.at[0] == Approx(0.5));
    CHECK(r.at[1] == Approx(-0.5 + 0.99 * 0.5));
    for (const Optimiser optimiser : {Optimiser::lbfgs, Optimiser::cobyla})
        CHECK((optimise(p, by(optimiser)).at - r.at).norm() < 2e-3);
    p.curvature(0, 0) = -1;
    CHECK_THROWS_WITH(optimise(p, o), "the curvature is not positive definite");
}

TEST_CASE("an equality is held, and one out of reach is not success") {
    for (const Optimiser optimiser : {Optimiser::slsqp, Optimiser::cobyla}) {
        INFO(to_string(optimiser));
        OptimiseProblem p = valley();
        p.equalities = {sum_is(1)};
        OptimiseResult r = optimise(p, by(optimiser));
        CHECK(r.end == OptimiseEnd::least);
        CHECK(r.at.sum() == Approx(1).margin(1e-5));
        p.equalities = {sum_is(5)}; // within the bounds it is 4 at most
        r = optimise(p, by(optimiser));
        CHECK((r.end == OptimiseEnd::unreachable || r.end == OptimiseEnd::failed));
        CHECK(r.worst == "the sum");
        CHECK(r.unequal == Approx(1).margin(1e-3)); // the nearest there is
    }
}

TEST_CASE("what NLopt would call success is an error: no number, no value, an exception, a start outside") {
    for (const Optimiser optimiser : {Optimiser::slsqp, Optimiser::lbfgs, Optimiser::cobyla}) {
        INFO(to_string(optimiser));
        OptimiseProblem p = valley();
        p.value = [](const VectorXd&, VectorXd*) { return std::nan(""); };
        CHECK_THROWS_WITH(optimise(p, by(optimiser)), "the objective is not a number");
        p.value = [](const VectorXd&, VectorXd* g) {
            if (g) g->setZero();
            return std::numeric_limits<double>::infinity();
        };
        const OptimiseResult r = optimise(p, by(optimiser));
        CHECK(r.end == OptimiseEnd::failed);
        CHECK(r.why == "the objective has no value at the start");
        p.value = [](const VectorXd&, VectorXd*) -> double { throw std::runtime_error("the cloth is gone"); };
        CHECK_THROWS_WITH(optimise(p, by(optimiser)), "the cloth is gone");
        p = valley();
        p.start[1] = 3;
        CHECK_THROWS_WITH(optimise(p, by(optimiser)), "unknown 1 starts at 3, outside of its bounds -2 and 2");
    }
    OptimiseProblem p = valley();
    p.value = [](const VectorXd& v, VectorXd* g) {
        if (g) g->setConstant(std::nan(""));
        return v.squaredNorm();
    };
    CHECK_THROWS_WITH(optimise(p, by(Optimiser::slsqp)), "a gradient is not a number");
}

TEST_CASE("places without a value are stepped back from, limits are said, and useless choices refused") {
    OptimiseProblem p = valley();
    const Differentiable whole = p.value;
    p.value = [whole](const VectorXd& v, VectorXd* g) {
        return v[1] > 1.5 ? std::numeric_limits<double>::infinity() : whole(v, g);
    };
    CHECK((optimise(p, by(Optimiser::slsqp)).at - VectorXd::Ones(2)).norm() < 1e-3);

    OptimiseOptions few = by(Optimiser::slsqp);
    few.max_evaluations = 3;
    CHECK(optimise(valley(), few).end == OptimiseEnd::evaluations);
    p = valley();
    p.stop = [] { return true; };
    CHECK(optimise(p, by(Optimiser::slsqp)).end == OptimiseEnd::stopped);

    p = valley();
    p.equalities = {sum_is(1)};
    CHECK_THROWS_AS(optimise(p, by(Optimiser::lbfgs)), std::invalid_argument);
    p.equalities = {sum_is(1), sum_is(2), sum_is(3)};
    CHECK_THROWS_WITH(optimise(p, by(Optimiser::slsqp)), "3 equalities for 2 unknowns");
    p = valley();
    p.start = p.low = p.high = VectorXd::Zero(11);
    CHECK_THROWS_WITH(optimise(p, by(Optimiser::cobyla)), "cobyla is for at most 10 unknowns, here are 11");
}
