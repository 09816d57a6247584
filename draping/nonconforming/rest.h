// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Equilibrium of cloth whose lengths are kept exactly: Newton's method on the set of isometric states.

#include "draping/nonconforming/saddle.h"

namespace toile {

/// Least of 1/2 sum A_ij x_i . x_j - sum load_i . x_i among states whose bars keep their lengths. Bending,
/// gravity, springs to places and inertia all are of that form: the lengths alone are not linear.
struct IsometricProblem {
    Eigen::SparseMatrix<double> stiffness; ///< A, N/m, positive semidefinite, both halves stored
    Points load;                           ///< N
    Bars bars;
    std::vector<char> held; ///< points that stay where they are
};

/// Adds stiffness (N/m) times half the squared distance from the point sum weight_i x_i to `place`. The
/// points should be near each other: they become coupled.
void add_spring(IsometricProblem& problem, const std::vector<std::pair<int, double>>& point,
                const Vec3& place, double stiffness);

struct IsometricOptions {
    double tolerance = 1e-9; ///< N, residual at rest: 1e-5 or less of a midpoint's weight
    double strain = 1e-7;    ///< of any bar at the end
    int max_iterations = 200;
    double max_turn = 0.5; ///< rad, that a bar turns by at most in one iteration
};

enum class IsometricEnd {
    settled,
    not_isometric, ///< no state that keeps the lengths was found near the start
    iterations,
    stalled ///< no step lowers the energy any more, and the forces do not balance
};

struct IsometricResult {
    IsometricEnd end = IsometricEnd::iterations;
    double residual = 0; ///< N, largest force on a point that nothing answers
    double strain = 0;   ///< largest of a bar
    double energy = 0;   ///< J, of the problem
    int iterations = 0, factorisations = 0;
    Eigen::VectorXd tension; ///< N per bar
};

/// Moves x to the nearest state that keeps the lengths, distances measured by the problem's stiffness so that
/// cloth is bent as little as can be. False when none is found to a strain of `strain`; x is then as near as
/// it came.
bool make_isometric(Saddle& saddle, const IsometricProblem& problem, Points& x, double strain = 1e-12);

/// Moves x to rest. It need not keep the lengths to begin with. `tension`, when it has the right size, is a
/// first guess.
IsometricResult settle_isometric(Saddle& saddle, const IsometricProblem& problem, Points& x,
                                 const IsometricOptions& options = {}, const Eigen::VectorXd& tension = {});

/// The second derivative at a state of rest is positive along isometric motions: a minimum, no saddle.
bool is_stable(Saddle& saddle, const IsometricProblem& problem, const Points& x,
               const Eigen::VectorXd& tension);

} // namespace toile
