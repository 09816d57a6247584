// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Implicit Euler with velocities, one Newton step each (Baraff, Witkin: Large Steps in Cloth Simulation, 1998), on any
// problem without contact of its own. The forces of contact of the last step stand in the solve, and what the body held
// is held in it by the method of multipliers (Hestenes 1969), so that what leans on the body is at rest when its forces
// are in balance, however stiff it is and however long the step.

#include "draping/algebra/cholesky.h"
#include "draping/solve/node_problem.h"
#include "draping/solve/stepper.h"

namespace toile {

class ImplicitStepper final : public Stepper {
public:
    /// Keeps references to both.
    ImplicitStepper(NodeProblem& problem, Response& response, const StepOptions& options = {});

    ResponseDone step(Moving& cloth, const Points& body_end) override;
    double residual(const Moving& cloth) override;
    int worst_node() const override { return problem_.worst_node(); }
    Loads& loads() override { return problem_; }
    const std::vector<double>& node_mass() const override { return problem_.node_mass(); }
    StepOptions& options() override { return options_; }
    int factorisations() const override { return factorisations_; }

private:
    NodeProblem& problem_;
    Response& response_;
    StepOptions options_;
    Cholesky factor_;
    bool analysed_ = false; ///< the factor has the pattern of the problem's matrix
    int factorisations_ = 0;
};

/// Largest force on a node that contact did not answer in the last step.
double residual(NodeProblem& problem, const Moving& cloth);

} // namespace toile
