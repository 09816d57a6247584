// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/inextensible.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

constexpr double hold_share = 100; // of a node's mass, with which a touch holds it against the yarns

constexpr double line_share = 1e3; // of the mass that it moves, over dt2, with which a line is stiff in the solve
constexpr double beside_own = 5;   // times what else its ends are stiff by, added to that

} // namespace

InextensibleStepper::InextensibleStepper(std::unique_ptr<NodeProblem> problem, Tension& tension, Response& response,
                                         const StepOptions& options)
    : ImplicitStepper(std::move(problem), response, options), tension_(tension),
      projection_(problem_.points(), tension.lines()) {}

/// A node that the body holds would be pulled into it or along it, for the response to bring it back, which would lengthen the
/// yarns that hang from it in every step.
std::vector<Mat3> InextensibleStepper::mobility(const Moving& cloth) const {
    const int n = problem_.points();
    std::vector<Mat3> mass(n);
    for (int i = 0; i < n; ++i) mass[i] = problem_.node_mass()[i] * Mat3::Identity();
    for (const HeldTouch& h : cloth.touches)
        for (int k = 0; k < 4; ++k) {
            const int i = h.touch.point[k];
            if (i >= n || h.touch.weight[k] == 0) continue;
            const Mat3 held = h.slides ? Mat3(h.touch.normal * h.touch.normal.transpose()) : Mat3::Identity();
            mass[i] += hold_share * std::abs(h.touch.weight[k]) * problem_.node_mass()[i] * held;
        }
    for (int i = 0; i < n; ++i) mass[i] = pinned(i) ? Mat3::Zero() : Mat3(mass[i].inverse());
    return mass;
}

/// Lines are stiff in the solve, beside mass and beside shear, so that projecting has little left to do: it knows no stiffness, of
/// shear or of what holds the cloth, and would put energy into it.
void InextensibleStepper::stiffen(const Points& x) {
    const double dt = options_.time_step;
    const std::vector<double> inverse = inverse_mass();
    if (own_stiffness_.empty()) { // lines have none yet
        bool pattern_changed = false;
        problem_.arrive(x);
        own_stiffness_ = own_stiffness(problem_.hessian(x, false, pattern_changed));
    }
    for (std::size_t k = 0; k < tension_.lines().size(); ++k) {
        const LengthConstraint& c = tension_.lines()[k];
        const double mobility = inverse[c.a] + inverse[c.b], now = strain(c, x);
        const double own = own_stiffness_[c.a] + own_stiffness_[c.b];
        tension_.stiffness[k] = mobility > 0 ? line_share / (mobility * dt * dt) + beside_own * own : 0;
        tension_.target[k] = c.length * (1 + now - std::clamp(now, -drawn_in, drawn_in));
    }
}

void InextensibleStepper::constrain(const Moving& cloth, Points& v) {
    const double dt = options_.time_step;
    for (std::size_t k = 0; k < tension_.lines().size(); ++k) {
        const LengthConstraint& c = tension_.lines()[k];
        tension_.newtons[k] += tension_.stiffness[k] * (violation(c, tension_.target[k], cloth.x) +
                                                        dt * slope(c, cloth.x).dot(v[c.b] - v[c.a]));
    }
    slow(v, dt, options_.max_motion);
    Points x = cloth.x;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += dt * v[i];
    projected_ = projection_.project(mobility(cloth), dt, tension_.target, cloth.x, x, tension_.newtons);
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = (x[i] - cloth.x[i]) / dt;
}

ResponseDone InextensibleStepper::step(Moving& cloth, const Points& body_end) {
    stiffen(cloth.x);
    const ResponseDone done = ImplicitStepper::step(cloth, body_end);
    strain_ = 0;
    for (std::size_t k = 0; k < tension_.lines().size(); ++k) {
        strain_ = std::max(strain_, std::abs(strain(tension_.lines()[k], cloth.x)));
        tension_.stiffness[k] = 0; // the forces at rest are those of the tensions
        tension_.target[k] = tension_.lines()[k].length;
    }
    return done;
}

} // namespace toile
