// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/projective.h"

#include <limits>
#include <stdexcept>

namespace toile {

namespace {

/// The loads as springs that pull in every direction alike and without end, which bound what they do.
Loads bounding(Loads loads) {
    constexpr double uncapped = std::numeric_limits<double>::infinity();
    for (StitchSpring& s : loads.stitches) s.cap = uncapped;
    for (HookSpring& s : loads.hooks) s.cap = uncapped;
    for (const ElasticSegment& s : loads.elastics) loads.stitches.push_back({s.a, {s.b, s.b}, 0, s.stiffness / s.rest, uncapped});
    loads.elastics.clear();
    return loads;
}

} // namespace

ProjectiveStepper::ProjectiveStepper(std::unique_ptr<NodeProblem> problem, const BoundedEnergy& energy, Response& response,
                                     const StepOptions& options, int iterations)
    : ProblemStepper(std::move(problem), response, options), energy_(energy), iterations_(iterations) {}

void ProjectiveStepper::prepare() {
    const double dt = options_.time_step, share = (1 + options_.damping * dt) / (dt * dt);
    if (factorisations_ > 0 && share == prepared_share_ && prepared_ == problem_) return;
    prepared_ = problem_;
    prepared_share_ = share;
    const Loads loads = bounding(problem_);
    std::vector<std::pair<int, int>> pairs;
    energy_.couplings(pairs);
    couplings(loads, pairs);
    BlockMatrix a(problem_.points(), pairs);
    energy_.add_bound(a);
    add_hessian(loads, Points(problem_.points(), Vec3::Zero()), a); // of springs without a cap it is the same everywhere
    a.add_to_diagonal(share * problem_.mass());
    a.pin(problem_.pinned());
    factor_.analyse(a);
    ++factorisations_;
    if (!factor_.factorise(a)) throw std::runtime_error("the matrix of projective dynamics is not positive definite");
}

ResponseDone ProjectiveStepper::step(Moving& cloth, const Points& body_end) {
    prepare();
    const double dt = options_.time_step;
    cloth.velocity.resize(cloth.x.size(), Vec3::Zero());
    Points x = cloth.x;
    Eigen::VectorXd g, dx;
    for (int k = 0; k < iterations_; ++k) {
        problem_.gradient(x, g);
        g += problem_.mass().cwiseProduct(prepared_share_ * (flat(x) - flat(cloth.x)) - flat(cloth.velocity) / dt);
        for (int i = 0; i < problem_.points(); ++i) g.segment<3>(3 * i) -= lasting(cloth, i);
        for (int i = 0; i < problem_.points(); ++i)
            if (pinned(i)) g.segment<3>(3 * i).setZero();
        factor_.solve(g, dx);
        flat(x) -= dx;
    }
    Points v(x.size());
    flat(v) = (flat(x) - flat(cloth.x)) / dt;
    return go(cloth, response_, inverse_mass(), body_end, options_, v);
}

} // namespace toile
