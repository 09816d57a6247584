// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Sparse Cholesky of a BlockMatrix: CHOLMOD, supernodal, nested dissection on the graph of points.

#include "draping/algebra/block_matrix.h"

#include <memory>

namespace toile {

class Cholesky {
public:
    Cholesky();
    ~Cholesky();
    Cholesky(Cholesky&&) noexcept;
    Cholesky& operator=(Cholesky&&) noexcept;

    /// Symbolic analysis for the pattern of `a`. With `keep_order`, the order of an earlier analysis of as many
    /// points is used again, which is cheap, unless the blocks (contacts) that have come since make the factorisation
    /// take half as much work again as when the order was new.
    void analyse(const BlockMatrix& a, bool keep_order = false);

    /// Floating-point operations of a factorisation by the last analysis.
    double work() const;

    /// Numeric factorisation of a matrix with the analysed pattern. False when it is not positive definite.
    bool factorise(const BlockMatrix& a);

    /// x = A^-1 b by the last factorise(), which must have succeeded, with no factorise_preconditioner() since: one factor is kept.
    void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x);

    /// A factorisation in single precision where the matrix allows it, several times faster, or else in double precision.
    /// False when the matrix is not positive definite.
    bool factorise_preconditioner(const BlockMatrix& a);

    /// x = A^-1 b to about six digits by the last factorisation of either kind, which must have succeeded.
    void precondition(const Eigen::VectorXd& b, Eigen::VectorXd& x);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace toile
