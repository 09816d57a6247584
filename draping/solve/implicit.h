// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Implicit Euler with velocities, one Newton step each (Baraff, Witkin: Large Steps in Cloth Simulation, 1998), on any
// problem without contact of its own. The forces of contact of the last step stand in the solve, and what the body held is held in it.

#include "draping/algebra/cholesky.h"
#include "draping/solve/held_touches.h"
#include "draping/solve/problem_stepper.h"

namespace toile {

/// Per node, a third of the trace of its own entries (N/m of a second derivative).
std::vector<double> own_stiffness(const BlockMatrix& a);

class ImplicitStepper : public ProblemStepper {
public:
    using ProblemStepper::ProblemStepper;

    ResponseDone step(Moving& cloth, const Points& body_end) override;
    int factorisations() const override { return factorisations_; }

protected:
    /// Before contact is looked for: the place for constraints. `v` is what moves the cloth, m/s.
    virtual void constrain(const Moving& cloth, Points& v) { (void)cloth, (void)v; }

private:
    Points candidate(Moving& cloth, HeldTouches& touches);
    Eigen::VectorXd solution(const BlockMatrix& a, const Eigen::VectorXd& b);

    Cholesky factor_;
    bool analysed_ = false; ///< the factor has the pattern of the problem's matrix
    int factorisations_ = 0;
};

} // namespace toile
