// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Equilibrium by Newton steps in pseudo-time: implicit Euler without momentum whose time step grows until it is
// Newton's method; at the end, Newton-CG on the exact Hessian within a trust region (Steihaug 1983).

#include "draping/algebra/cholesky.h"
#include "draping/solve/problem.h"

#include <functional>
#include <limits>

namespace toile {

struct SettleOptions {
    double tolerance = 1e-3;      ///< residual at which the state counts as settled
    int max_iterations = 500;
    double time_step = 0.02;      ///< s, first pseudo-time step
    double max_step = 0.01;       ///< m, no point moves farther in one iteration
    double exact_below = 20;      ///< residual below which the exact Hessian is used
    double still = 0;             ///< m, also settled when a full step moves no point farther than this
    double still_below = std::numeric_limits<double>::infinity(); ///< and leads to a residual of at most this
    /// Called now and then with the state that a Newton step has led to, the step, and the residual before it: may bring x
    /// nearer to rest where most of the motion is. Returns whether it moved x.
    std::function<bool(Points& x, const Eigen::VectorXd& step, double residual)> relax_part;
    /// Called after every iteration; false stops.
    std::function<bool(int iteration, double residual)> progress;
};

enum class SettleEnd { settled, iterations, stalled, stopped };

struct SettleResult {
    SettleEnd end = SettleEnd::iterations;
    double residual = 0;
    double energy = 0;
    double motion = std::numeric_limits<double>::infinity(); ///< m, of the point that the last step moved farthest; infinity: no step
    int iterations = 0;
    int factorisations = 0;
    int conjugate_gradients = 0;
};

/// Moves x to a minimum of the problem as far as the options allow. Every state on the way is feasible.
SettleResult settle(Problem& problem, Points& x, Cholesky& factor, const SettleOptions& options);

} // namespace toile
