// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// How long a step symplectic Euler bears.

#include "draping/solve/node_problem.h"

namespace toile {

/// Of M^-1 K and M^-1 D over the nodes that are not pinned, K positive semidefinite.
struct Fastest {
    double stiffness = 0; ///< 1/s2, largest eigenvalue: the highest frequency squared
    double damping = 0;   ///< 1/s

    /// The longest step that is stable, s: w^2 dt^2 + 2 d dt = 4, which is 2 / w without damping. Sharp when both are reached
    /// by the same motion, as with damping proportional to stiffness; safe otherwise. Infinity when nothing resists.
    double step() const;
};

/// The motions that were fastest, scaled by the root of the mass; empty before the first.
struct FastestMotions {
    Eigen::VectorXd stiffness, damping;
};

/// By the method of Lanczos, which comes from below; off by less than a percent on sheets. Starts from the motions
/// that were fastest at a place near x, when there are any, with a third of the work, and leaves those of x.
Fastest fastest(NodeProblem& problem, const Points& x, FastestMotions* from = nullptr);

} // namespace toile
