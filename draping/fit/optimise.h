// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// NLopt behind one door, which tells success from what only looks like it: a value that is not a number, an equality that
// is not reached, an error on the way.

#include <Eigen/Core>

#include <functional>
#include <string>
#include <vector>

namespace toile {

enum class Optimiser { slsqp, lbfgs, cobyla };

/// The word of specs and reports: "slsqp", "lbfgs", "cobyla".
const char* to_string(Optimiser optimiser);

/// A function of the unknowns; `gradient` is null where it is not asked for.
using Differentiable = std::function<double(const Eigen::VectorXd& at, Eigen::VectorXd* gradient)>;

struct Equality {
    std::string name;
    Differentiable value; ///< to be 0
};

struct OptimiseProblem {
    Eigen::VectorXd start, low, high;
    Differentiable value;             ///< to be least; infinity: not there, a shorter step is tried
    std::vector<Equality> equalities; ///< none for lbfgs
    /// An estimate of the second derivative at the start, positive definite; empty: the identity. It sets the scale of all
    /// unknowns, and for slsqp their directions too.
    Eigen::MatrixXd curvature;
    /// Called after every evaluation; true ends it as `stopped`.
    std::function<bool()> stop;
};

struct OptimiseOptions {
    Optimiser optimiser = Optimiser::slsqp;
    int max_evaluations = 100;
    double equal_within = 1e-5;     ///< in the unit of equalities
    double value_tolerance = 1e-4;  ///< ends when the value changes by less than this share of itself
    double step_tolerance = 1e-4;   ///< or the unknowns by less, over their scale
    double first_step = 1;          ///< of cobyla, over the scale of an unknown
};

enum class OptimiseEnd { least, evaluations, stopped, unreachable, failed };

struct OptimiseResult {
    OptimiseEnd end = OptimiseEnd::failed;
    Eigen::VectorXd at;   ///< the least value among evaluations that hold the equalities, or the one nearest to holding them
    double value = 0;
    double unequal = 0;   ///< the largest equality there
    std::string worst;    ///< its name
    int evaluations = 0;
    std::string why;      ///< of `failed`: a sentence
};

/// Throws std::invalid_argument, a sentence, for a start outside of the bounds, bounds that cross, no unknown, more equalities
/// than unknowns, equalities for lbfgs, more than ten unknowns for cobyla; and whatever `value` or an equality throws.
OptimiseResult optimise(const OptimiseProblem& problem, const OptimiseOptions& options);

} // namespace toile
