// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Impulses on ghost nodes that give these a velocity: what contact does, as midpoints feel it.

#include "draping/nonconforming/midpoints.h"

#include <Eigen/SparseCholesky>

namespace toile {

class GhostImpulses {
public:
    /// Midpoints that are `held` are not moved.
    GhostImpulses(const Midpoints& midpoints, const std::vector<char>& held);

    /// Velocities of midpoints, of the least kinetic energy, that change the velocities of ghost nodes by `change` (m/s): the q
    /// with P M^-1 P^T q = change, as M^-1 P^T q. Nodes that no midpoint can move stay as they are.
    Points velocities(const Points& change) const;

private:
    Eigen::SparseMatrix<double, Eigen::RowMajor> ghost_;
    Eigen::VectorXd mobility_; ///< 1/kg per midpoint
    Eigen::SparseMatrix<double> of_ghosts_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

} // namespace toile
