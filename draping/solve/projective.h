// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Projective dynamics: implicit Euler by local and global steps with one factor for all of them. In the terms of Liu,
// Bouaziz, Kavan (Quasi-Newton Methods for Real-Time Simulation of Hyperelastic Materials, 2017) a step of Newton's method
// with a constant matrix that bounds the second derivative. For previews: what is stiffer than the matrix says
// nowhere, but softer where it bends, comes closer by a share of about the strain per iteration.

#include "draping/algebra/cholesky.h"
#include "draping/energy/projective.h"
#include "draping/solve/problem_stepper.h"

namespace toile {

class ProjectiveStepper final : public ProblemStepper {
public:
    /// `energy` is the problem's. `iterations` of local and global steps per step in time.
    ProjectiveStepper(std::unique_ptr<NodeProblem> problem, const BoundedEnergy& energy, Response& response,
                      const StepOptions& options, int iterations = 10);

    ResponseDone step(Moving& cloth, const Points& body_end) override;
    int factorisations() const override { return factorisations_; }

private:
    void prepare();

    const BoundedEnergy& energy_;
    int iterations_;
    Cholesky factor_;
    Loads prepared_; ///< the loads that the factor has
    double prepared_share_ = 0; ///< of the mass in it, 1/s2
    int factorisations_ = 0;
};

} // namespace toile
