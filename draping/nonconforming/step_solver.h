// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// One step in time of cloth that keeps its lengths: the least of energy and inertia among states whose bars have theirs. Newton's
// method as in rest.h, with each of its systems solved by conjugate gradients among motions that change no length (Gould, Hribar,
// Nocedal 2001): the matrix W is only multiplied by, and what is factorised is the dual of its diagonal. Inertia
// dominates W, so that few iterations do; at rest, where it does not, rest.h is the one.

#include "draping/nonconforming/dual.h"
#include "draping/nonconforming/midpoints.h"
#include "draping/nonconforming/rest.h"

namespace toile {

/// Least of the energy of `problem`, inertia and load. What acts on ghost nodes is linear about the start of the step: forces
/// are part of `load`, and grow with the way of the ghost nodes by `ghost_stiffness`.
struct StepProblem {
    const IsometricProblem& problem; ///< its load is not looked at
    const Midpoints& midpoints;
    Points load;                     ///< N per midpoint, that of inertia and of `problem` with it
    std::vector<double> inertia;     ///< N/m per midpoint
    const BlockMatrix* ghost_stiffness = nullptr; ///< N/m over nodes, positive semidefinite; null: none
    const Points& start;             ///< of midpoints
    Eigen::VectorXd slack;           ///< m, per bar: the misfit that is left for later steps
};

struct StepSolverOptions {
    double tolerance = 1e-9;      ///< N, residual
    double strain = 1e-9;         ///< of any bar, beyond its slack
    int max_iterations = 50;
    double linear = 3e-3;         ///< share of the residual that the linear systems leave
    int max_linear = 1000;        ///< iterations in each
};

class StepSolver {
public:
    StepSolver(const IsometricProblem& problem, const std::vector<HeldPlace>& places);

    /// Moves x to the end of the step. `tension`, per condition, is the first guess and comes back as the last. The end is
    /// `settled`, or `iterations` when these are over before. Throws std::runtime_error when numbers are not finite.
    IsometricResult step(const StepProblem& p, Points& x, Eigen::VectorXd& tension, const StepSolverOptions& options);

    /// J^T tension at x: what bars and held places pull with, as a gradient.
    Eigen::VectorXd pulls(const Points& x, const Eigen::VectorXd& tension);

    int factorisations() const { return dual_.factorisations(); } ///< so far
    long linear_iterations() const { return linear_iterations_; } ///< so far

private:
    bool factorise(const std::vector<Mat3>& diagonal);
    /// Back to the lengths, by the last linearisation and as far as that leads; the centre of mass stays.
    void restore(const StepProblem& p, Points& x, double strain);
    Eigen::VectorXd misfits(const StepProblem& p, const Points& x) const;

    IsometryDual dual_;
    std::vector<char> held_;
    bool loose_ = false; ///< nothing is held: momentum is to be kept
    long linear_iterations_ = 0;
};

} // namespace toile
