// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A symmetric sparse matrix of 3x3 blocks, one block row and column per point, lower triangle stored.

#include "geometry/types.h"

#include <cassert>
#include <utility>

namespace toile {

/// Values lie in the scalar compressed-column layout that a sparse Cholesky takes, so that nothing is copied.
class BlockMatrix {
public:
    BlockMatrix() = default;

    /// Room for the diagonal and for every block (i, j) of `pairs` (either order, repeats allowed).
    BlockMatrix(int block_rows, const std::vector<std::pair<int, int>>& pairs);

    int block_rows() const { return int(column_.size()) - 1; }
    int rows() const { return 3 * block_rows(); }

    /// Slot of block (i, j), i >= j; -1 when the pattern has no such block.
    int find(int i, int j) const;

    void set_zero();

    /// Adds `a` to block (i, j), i > j, at `slot` = find(i, j).
    void add_off_diagonal(int j, int slot, const Mat3& a) {
        assert(slot >= 0); // the pattern has the block
        for (int c = 0; c < 3; ++c) {
            double* column = column_data(j, slot, c);
            for (int r = 0; r < 3; ++r) column[r] += a(r, c);
        }
    }
    /// Adds a symmetric block on the diagonal.
    void add_diagonal(int i, const Mat3& a) {
        for (int c = 0; c < 3; ++c) {
            double* column = column_data(i, column_[i], c);
            for (int r = c; r < 3; ++r) column[r] += a(r, c);
        }
    }
    /// Adds the symmetric matrix `a` of an element, three rows per node, whose nodes the pattern couples.
    template <std::size_t N>
    void add_element(const std::array<int, N>& nodes, const Eigen::Matrix<double, 3 * int(N), 3 * int(N)>& a) {
        for (int k = 0; k < int(N); ++k) {
            add_diagonal(nodes[k], a.template block<3, 3>(3 * k, 3 * k));
            for (int l = 0; l < k; ++l) {
                const bool below = nodes[k] > nodes[l];
                const int row = below ? k : l, column = below ? l : k;
                add_off_diagonal(nodes[column], find(nodes[row], nodes[column]),
                                 a.template block<3, 3>(3 * row, 3 * column));
            }
        }
    }
    void add_to_diagonal(const Eigen::VectorXd& d); ///< one entry per scalar row

    /// Rows and columns of pinned points become those of the identity: they stay where they are.
    void pin(const std::vector<char>& pinned);

    /// y = A x.
    void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;

    // The layout as a sparse Cholesky wants it: lower triangle, by scalar columns.
    const std::vector<int>& scalar_columns() const { return scalar_column_; }
    const std::vector<int>& scalar_rows() const { return scalar_row_; }
    const std::vector<double>& values() const { return value_; }
    // The same by blocks, for ordering.
    const std::vector<int>& block_columns() const { return column_; }
    const std::vector<int>& block_row_indices() const { return row_; }

private:
    std::vector<int> column_{0}; ///< block column j has slots [column_[j], column_[j + 1]), diagonal first
    std::vector<int> row_;       ///< block row of each slot, ascending within a column
    std::vector<int> scalar_column_, scalar_row_;
    std::vector<double> value_;

    /// Column c of the block at `slot` of block column j, to be indexed by the block's row. In scalar column
    /// 3j + c the diagonal block stores rows c..2 only, so every later block starts c entries earlier.
    double* column_data(int j, int slot, int c) {
        return value_.data() + scalar_column_[3 * j + c] + 3 * (slot - column_[j]) - c;
    }
};

} // namespace toile
