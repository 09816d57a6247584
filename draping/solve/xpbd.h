// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Position-based dynamics with compliance (Macklin, Mueller, Chentanez: XPBD, 2016), in small steps (Macklin et al.: Small
// Steps in Physics Simulation, 2019). For previews: information spreads by one node per sweep, so that a sheet of N
// nodes needs of the order of N^2 sweeps to be as stiff as it is said to be. Multipliers begin a substep as they ended the
// last one: where nothing moves every constraint then has the force of its energy, which one sweep from zero would not find.

#include "draping/energy/constraint.h"
#include "draping/solve/problem_stepper.h"

namespace toile {

struct XpbdOptions {
    int substeps = 8; ///< of a step, with one contact at its end
    int sweeps = 1;   ///< over all constraints in each, in their order
};

/// One constraint, where it acted, and with what.
struct Constrained {
    Constraint constraint;
    double force = 0; ///< its multiplier, N per gradient
};

class XpbdStepper final : public ProblemStepper {
public:
    /// `energy` is the problem's.
    XpbdStepper(std::unique_ptr<NodeProblem> problem, const ConstraintEnergy& energy, Response& response,
                const StepOptions& options, const XpbdOptions& how = {});

    ResponseDone step(Moving& cloth, const Points& body_end) override;

private:
    void substep(const Moving& cloth, Points& x, Points& v, const std::vector<double>& inverse_mass, double h);

    const ConstraintEnergy& energy_;
    XpbdOptions how_;
    Loads acting_;
    std::vector<Constrained> last_; ///< of energy and loads, in the last substep
};

} // namespace toile
