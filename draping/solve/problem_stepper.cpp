// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/problem_stepper.h"

namespace toile {

ProblemStepper::ProblemStepper(NodeProblem& problem, Response& response, const StepOptions& options)
    : problem_(problem), response_(response), options_(options) {}

ProblemStepper::ProblemStepper(std::unique_ptr<NodeProblem> problem, Response& response, const StepOptions& options)
    : owned_(std::move(problem)), problem_(*owned_), response_(response), options_(options) {}

double ProblemStepper::residual(const Moving& cloth) {
    problem_.arrive(cloth.x);
    Eigen::VectorXd g;
    problem_.gradient(cloth.x, g);
    const Points force = cloth.contact_force();
    for (int i = 0; i < problem_.points(); ++i)
        if (!pinned(i)) g.segment<3>(3 * i) -= force[i] + held(i);
    return problem_.residual(cloth.x, g);
}

std::vector<double> ProblemStepper::inverse_mass() const {
    std::vector<double> inverse(problem_.points(), 0.0);
    for (int i = 0; i < problem_.points(); ++i)
        if (!pinned(i)) inverse[i] = 1 / problem_.node_mass()[i];
    return inverse;
}

} // namespace toile
