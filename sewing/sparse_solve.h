// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace toile {

/// x of A x = b for a symmetric positive definite A of which only the lower triangle is read; b has one column
/// per right-hand side. By CHOLMOD. Throws std::runtime_error when A is not positive definite.
Eigen::MatrixXd solve_definite(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& b);

} // namespace toile
