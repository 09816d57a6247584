// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A cloth in motion: implicit Euler with velocities, one Newton step each (Baraff, Witkin: Large Steps in Cloth
// Simulation, 1998), on any Problem; what it meets is left to a response. The forces of contact of the last step
// stand in the solve, and what the body held is held in it by the method of multipliers (Hestenes 1969), so that what
// leans on the body is at rest when its forces are in balance, however stiff it is and however long the step.

#include "draping/algebra/cholesky.h"
#include "draping/contact/response.h"
#include "draping/solve/problem.h"

#include <functional>

namespace toile {

struct StepOptions {
    double time_step = 2e-3; ///< s
    double damping = 0;      ///< 1/s: share of the momentum that air takes per second
    double max_motion = 0.01; ///< m, no point moves farther in one step; faster ones are slowed
};

/// A touch that lasts from step to step.
struct HeldTouch {
    Touch touch;
    bool slides = false;
    bool began = false; ///< to slide, in the last step
};

/// A cloth on its way, and what contact did to it in the last step. Starts with `x` alone.
struct Moving {
    Points x;
    Points velocity = {};                ///< m/s; empty: at rest
    std::vector<HeldTouch> touches = {}; ///< sorted
    Points other_force = {};             ///< N per node, of all other contact
    bool analysed = false;               ///< the factor has the pattern of the problem's matrix
    int factorisations = 0;              ///< so far

    /// Force of contact on every node in the last step, N.
    Points contact_force() const;
};

/// One step, at whose end the points of the body are at `body_end`. The problem has no contact of its own. Throws
/// std::runtime_error when the motion is no longer finite.
ResponseDone step(Problem& problem, Response& response, Moving& cloth, const Points& body_end, Cholesky& factor,
                  const StepOptions& options);

/// Largest force on a node that contact did not answer in the last step, as Problem::residual() measures it.
double residual(Problem& problem, const Moving& cloth);
double kinetic_energy(const Problem& problem, const Moving& cloth); ///< J

struct RestOptions {
    StepOptions step;
    double tolerance = 1e-3; ///< residual at rest
    double speed = 1e-3;     ///< m/s, mean square root, at rest
    int max_steps = 5000;
    /// Called after every step; false stops.
    std::function<bool(int step, double residual)> progress;
};

struct RestResult {
    bool rested = false;  ///< both the forces and the speed are below what was asked for
    bool stopped = false; ///< by the caller
    double residual = 0;
    double speed = 0;   ///< m/s, root of the mean square over the mass
    int steps = 0;
    int factorisations = 0;
    int unresolved = 0; ///< steps that left impacts unresolved
};

/// Steps with the body at rest until the cloth is.
RestResult come_to_rest(Problem& problem, Response& response, Moving& cloth, Cholesky& factor,
                        const RestOptions& options);

} // namespace toile
