// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Systems of a minimisation under conditions:
//     [ W  J^T ] [ d ]     [ g ]
//     [ J   0  ] [ y ] = - [ c ],    W = stiffness (x) I3 + shift I + sum lambda_i c_i'',    J = c',
// by the method of multipliers (Hestenes 1969) on one sparse Cholesky factor of W + k J^T J: with k far above
// W on the lengths, every round gains three digits. The factor exists just when W is positive definite along
// J d = 0 (for k large enough: Debreu 1952), which LU of the whole could not tell, and no pivots are needed,
// so the pattern stays.

#include "draping/algebra/cholesky.h"
#include "draping/nonconforming/isometry.h"

#include <Eigen/SparseCore>

namespace toile {

class Saddle {
public:
    /// Analyses the pattern of `stiffness` (symmetric, one row per point, both halves) and of the bars.
    /// Points that are `held` have d = 0.
    Saddle(const Eigen::SparseMatrix<double>& stiffness, Bars bars, std::vector<char> held);

    /// Linearises at x. False when W is not positive definite along J d = 0. `stiffness` has the pattern of
    /// the constructor.
    bool factorise(const Eigen::SparseMatrix<double>& stiffness, double shift, const Points& x,
                   const Eigen::VectorXd& lambda);

    /// d and y by the last factorisation, which must have succeeded. True when |J d + c| has fallen below
    /// 1e-10 of what it was with y = 0; when conditions depend on each other and contradict, it cannot.
    bool solve(const Eigen::VectorXd& g, const Eigen::VectorXd& c, Eigen::VectorXd& d, Eigen::VectorXd& y);

    /// The step that makes up for the misfits c at once, of least size as W measures it: one round of the
    /// above with g = 0.
    void restore(const Eigen::VectorXd& c, Eigen::VectorXd& d);

    const Bars& bars() const { return bars_; }
    int factorisations() const { return factorisations_; }

private:
    void clear_held(Eigen::VectorXd& v) const;

    Bars bars_;
    std::vector<char> held_;
    BlockMatrix matrix_;
    std::vector<int>
        slot_of_entry_; ///< of every stored entry of the stiffness, in its order; -1 above the diagonal
    std::vector<int> slot_of_bar_;
    Cholesky factor_;
    Points at_;
    double penalty_ = 0; ///< N/m
    int factorisations_ = 0;
};

} // namespace toile
