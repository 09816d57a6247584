// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Fast projection onto lengths (Goldenthal, Harmon, Fattal, Bercovier, Grinspun: Efficient Simulation of Inextensible Cloth,
// 2007): where a step without constraints has led, brought back to the places of the right lengths that need the
// least kinetic energy, nearly, by Newton's method on the multipliers alone.

#include "draping/energy/tension.h"

#include <Eigen/SparseCholesky>

namespace toile {

struct ProjectionOptions {
    double tolerance = 1e-8; ///< largest |strain|
    int max_iterations = 12;
};

struct ProjectionDone {
    bool converged = false; ///< all lengths have the tolerance; otherwise these are the best places that were found, and the
                            ///< tensions are as before
    double strain = 0;      ///< largest |strain| that is left, against the lengths asked for
    int iterations = 0;     ///< factorisations
};

class FastProjection {
public:
    /// Of so many points.
    FastProjection(int points, std::vector<LengthConstraint> constraints);

    ProjectionOptions options;

    /// Moves the ends of a step of dt seconds from `start` to `x` by -h^2 W J^T (sum of dtension), until they have the
    /// `lengths` (m, per constraint), and adds the multipliers to `tension` (N). Each iteration solves
    /// (h^2 J W J^T) dtension = C, the first one with C and J of `start`, so that at rest nothing turns the forces that hold
    /// it, the others with those of x. W: the mobility of every point, 1/kg, symmetric; 0 for what is pinned. What is held
    /// between points that do not move is left as it is. Where constraints depend on each other, tensions that cancel are kept small.
    ProjectionDone project(const std::vector<Mat3>& mobility, double dt, const std::vector<double>& lengths,
                           const Points& start, Points& x, std::vector<double>& tension);

private:
    /// What two constraints at a point (or one with itself) add to the matrix.
    struct Entry {
        int row, column, point;
        double sign;
        int slot;
    };

    bool solve(const std::vector<Mat3>& mobility, double dt, const Points& at, Eigen::VectorXd violation,
               const std::vector<double>& tension, Eigen::VectorXd& change);
    /// The motion that a change of tension brings about.
    Points motion(const std::vector<Mat3>& mobility, double dt, const Points& at, const Eigen::VectorXd& change) const;

    std::vector<LengthConstraint> constraints_;
    std::vector<Entry> entries_;
    double shortest_ = 0; ///< m
    Eigen::SparseMatrix<double> matrix_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

} // namespace toile
