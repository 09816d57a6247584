// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/algebra/block_matrix.h"

namespace toile {

/// An energy over points that solvers minimise without knowing what it is made of.
struct Problem {
    virtual ~Problem() = default;

    virtual int points() const = 0;

    /// Called at every new state before the calls below: the place to renew what is lagged (friction, limits).
    virtual void arrive(const Points& x) = 0;

    virtual double value(const Points& x) = 0; ///< infinity outside the feasible set
    virtual void gradient(const Points& x, Eigen::VectorXd& g) = 0;

    /// The second derivative at x; `exact`, or a positive semidefinite stand-in. The matrix belongs to the
    /// problem. `pattern_changed` is set when its pattern is not that of the last call, and left alone otherwise.
    virtual BlockMatrix& hessian(const Points& x, bool exact, bool& pattern_changed) = 0;

    /// Product of the exact second derivative with v, by the matrix of the last call of hessian() and what that
    /// matrix leaves out for the sake of a cheap factor.
    virtual void multiply(const Eigen::VectorXd& v, Eigen::VectorXd& product) const = 0;

    /// How the gradient, `g` at x, changes per step along d: the exact second derivative's product with d, whatever
    /// matrix was asked for last.
    virtual void curvature_along(const Points& x, const Eigen::VectorXd& g, const Eigen::VectorXd& d,
                                 Eigen::VectorXd& hd) = 0;

    /// Largest t in [0, 1] for which x .. x + t dx stays feasible. `shares`, when given, receives the same for each
    /// point as far as it is itself in the way, 1 for most: a hint, since points that go different shares of
    /// their ways may meet others.
    virtual double feasible_step(const Points& x, const Eigen::VectorXd& dx, std::vector<double>* shares = nullptr) = 0;

    virtual double residual(const Points& x, const Eigen::VectorXd& g) = 0; ///< dimensionless size of the gradient
    virtual const Eigen::VectorXd& mass() const = 0;     ///< kg per scalar unknown
    virtual const std::vector<char>& pinned() const = 0; ///< per point
};

} // namespace toile
