// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Limits on the elongation of springs in explicit motion (Provot: Deformation Constraints in a Mass-Spring Model to Describe
// Rigid Cloth Behavior, 1995): after every substep, one spring after the other, ends that are too far apart move to
// where they may be, by their inverse masses, and their velocities with them.

#include "draping/energy/springs.h"
#include "draping/solve/explicit.h"
#include "draping/solve/sweep_order.h"

namespace toile {

class LimitedStepper final : public ExplicitStepper {
public:
    /// Limits those of `springs` that have a limit and are not for bending.
    LimitedStepper(std::unique_ptr<NodeProblem> problem, const std::vector<Spring>& springs, Response& response,
                   const StepOptions& options, const LimitOptions& limits);

private:
    void begin_step(const Points& x) override;
    void constrain(Points& x, Points& v, double h) override;
    Vec3 held(int node) const override { return impulse_.empty() ? Vec3::Zero() : Vec3(impulse_[node] / options_.time_step); }

    void sort(const Points& x);
    void sweep(Points& x, Points& v, double h);

    std::vector<Spring> springs_; ///< in the order of the sweep
    LimitOptions limits_;
    std::vector<double> inverse_mass_;
    Points impulse_; ///< N s per node, of the last step
};

} // namespace toile
