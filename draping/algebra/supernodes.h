// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Triangular solves with a supernodal factor that serves as a preconditioner. Such a solve costs the reading of
// the factor: here it is kept in single precision, half as much to read, and subtrees of the elimination tree
// that do not depend on each other are worked on at once.

#include <Eigen/Core>

#include <vector>

namespace toile {

/// A factor L with P A P^T = L L^T as dense blocks of columns, in the layout of CHOLMOD.
struct SupernodalFactor {
    int rows = 0, count = 0;      ///< of the matrix; of supernodes
    const int* first = nullptr;   ///< count + 1: first column of each supernode
    const int* row_begin = nullptr;   ///< count + 1: where each one's rows begin in `row`, its own columns first
    const int* value_begin = nullptr; ///< count + 1: where its column-major block begins in `value`
    const int* row = nullptr;
    const double* value = nullptr;
    const int* order = nullptr;   ///< rows: row of A at each place of P A P^T
};

class SupernodalSolver {
public:
    explicit SupernodalSolver(const SupernodalFactor& factor);

    /// x = A^-1 b to about six digits. The same bits for any number of threads.
    void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x);

private:
    /// Supernodes first .. last, descendants of the last and nobody else's.
    struct Subtree {
        int first, last;
        Eigen::VectorXf beyond; ///< what it takes off the columns shared with others
    };
    void find_subtrees();
    void forward(int s, Subtree* subtree);
    void backward(int s);

    int rows_ = 0;
    std::vector<int> first_, row_begin_, row_, order_;
    std::vector<int> value_begin_;
    std::vector<float> value_;
    std::vector<Subtree> subtrees_;
    std::vector<int> shared_;       ///< supernodes of no subtree, rising
    std::vector<int> shared_index_; ///< per column: place among the columns of `shared_`, or -1
    Eigen::VectorXf x_;
};

} // namespace toile
