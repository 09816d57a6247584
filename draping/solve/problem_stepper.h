// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/solve/node_problem.h"
#include "draping/solve/stepper.h"

#include <memory>

namespace toile {

/// What steppers over a NodeProblem have in common. Keeps references to problem and response.
class ProblemStepper : public Stepper {
public:
    ProblemStepper(NodeProblem& problem, Response& response, const StepOptions& options = {});
    /// The same with a problem of its own.
    ProblemStepper(std::unique_ptr<NodeProblem> problem, Response& response, const StepOptions& options = {});

    double residual(const Moving& cloth) override;
    int worst_node() const override { return problem_.worst_node(); }
    Loads& loads() override { return problem_; }
    const std::vector<double>& node_mass() const override { return problem_.node_mass(); }
    StepOptions& options() override { return options_; }

protected:
    bool pinned(int node) const { return problem_.pinned()[node]; }
    std::vector<double> inverse_mass() const; ///< 1/kg per node, 0 for pinned ones
    /// Force of contact on node i that the substeps of a step have, N: what a response that lasts did in the last step.
    Vec3 lasting(const Moving& cloth, int node) const {
        return response_.lasts() && !cloth.other_force.empty() ? cloth.other_force[node] : Vec3::Zero();
    }
    /// Force that the method itself holds node i with, N.
    virtual Vec3 held(int node) const { return (void)node, Vec3::Zero(); }

private:
    std::unique_ptr<NodeProblem> owned_;

protected:
    NodeProblem& problem_;
    Response& response_;
    StepOptions options_;
};

} // namespace toile
