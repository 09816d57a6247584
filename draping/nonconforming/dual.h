// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The systems of saddle.h with another matrix in the place of W, one block A for every midpoint:
//     [ A  J^T ] [ d ]     [ r ]
//     [ J   0  ] [ y ] = - [ c ],
// by the Schur complement J A^-1 J^T on the multipliers, as fast projection has it (Goldenthal et al. 2007). Triangles are its
// blocks and have three neighbours each, so that its Cholesky factor is far smaller than one over midpoints, whose bending
// couples some 60 of them. saddle.h has W itself and tells whether it is positive.

#include "draping/algebra/cholesky.h"
#include "draping/nonconforming/isometry.h"

namespace toile {

/// A place that stays: the weighted sum of some points.
using HeldPlace = std::vector<std::pair<int, double>>;

class IsometryDual {
public:
    /// The bars of every triangle one after the other, as triangle_bars() makes them. Places must be independent of each other.
    IsometryDual(int points, Bars bars, const std::vector<HeldPlace>& places);

    /// Multipliers: one per bar, then three per place.
    int conditions() const { return int(bars_.size()) + 3 * places_; }
    const Bars& bars() const { return bars_; }

    void linearise(const Points& x); ///< J is that at x from now on

    /// With `mobility` = A^-1 per point; 0: the point stays. Conditions that depend on each other give way by 1e-9 of what
    /// conditions give way to forces on average. False when numbers are not finite or a mobility is not positive.
    bool factorise(const std::vector<Mat3>& mobility);

    Eigen::VectorXd product(const Eigen::VectorXd& d) const;            ///< J d
    Eigen::VectorXd transpose_product(const Eigen::VectorXd& y) const;  ///< J^T y
    Eigen::VectorXd mobile(const Eigen::VectorXd& r) const;             ///< A^-1 r
    /// y of (J A^-1 J^T) y = c.
    Eigen::VectorXd multipliers(const Eigen::VectorXd& c);

    int factorisations() const { return factorisations_; }

private:
    struct Entry {
        int block = 0;      ///< of three conditions
        Mat3 slope;         ///< of these by the point
    };

    Bars bars_;
    int places_ = 0;
    std::vector<int> first_;       ///< point e has entries first_[e] .. first_[e + 1], rising by block
    std::vector<Entry> entries_;
    std::vector<std::array<int, 2>> entries_of_bar_; ///< that of a and that of b
    std::vector<int> slots_;       ///< of pairs of entries of a point, in their order
    std::vector<Mat3> mobility_;
    BlockMatrix matrix_;
    Cholesky factor_;
    int factorisations_ = 0;
};

} // namespace toile
