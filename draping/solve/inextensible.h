// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Implicit steps of what the cloth resists beside stretch, each followed by a fast projection onto the lengths of its yarns
// (Goldenthal, Harmon, Fattal, Bercovier, Grinspun 2007). The tensions of the last step stand in the solve, as contact
// does: with them a cloth at rest is where its forces are in balance, and the touches that hold it know what pulls at them.

#include "draping/solve/fast_projection.h"
#include "draping/solve/implicit.h"

namespace toile {

class InextensibleStepper final : public ImplicitStepper {
public:
    /// `tension` is part of the problem's energy and has the constraints.
    InextensibleStepper(std::unique_ptr<NodeProblem> problem, Tension& tension, Response& response, const StepOptions& options);

    /// Strain by which the lengths of a cloth that starts with wrong ones may change in a step, in (0, 1).
    double drawn_in = 1e-3;
    ProjectionOptions& projection() { return projection_.options; }

    ResponseDone step(Moving& cloth, const Points& body_end) override;

    const ProjectionDone& projected() const { return projected_; } ///< in the last step
    /// Largest |strain| after the last step: above what the projection left where contact had the last word.
    double largest_strain() const { return strain_; }

private:
    void stiffen(const Points& x);
    void constrain(const Moving& cloth, Points& v) override;
    std::vector<Mat3> mobility(const Moving& cloth) const;

    Tension& tension_;
    std::vector<double> own_stiffness_; ///< N/m, per node, of all but the lines, at the start
    FastProjection projection_;
    ProjectionDone projected_;
    double strain_ = 0;
};

} // namespace toile
