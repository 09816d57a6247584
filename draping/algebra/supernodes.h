// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A Cholesky factor that serves as a preconditioner: six digits are more than it needs. In single precision it is
// half as much to compute and to read, and subtrees of the elimination tree that do not depend on each other are
// worked on at once. Multifrontal, as Liu, The Multifrontal Method for Sparse Matrix Solution, 1992, describes.

#include "draping/algebra/block_matrix.h"

#include <Eigen/Core>

#include <vector>

namespace toile {

/// Where the entries of L with P A P^T = L L^T lie: dense blocks of columns, in the layout of CHOLMOD, supernodes
/// in postorder. Nothing is kept of the arrays.
struct SupernodalPattern {
    int rows = 0, count = 0;      ///< of the matrix; of supernodes
    const int* first = nullptr;   ///< count + 1: first column of each supernode
    const int* row_begin = nullptr;   ///< count + 1: where each one's rows begin in `row`, its own columns first
    const int* value_begin = nullptr; ///< count + 1: where its column-major block begins among the values
    const int* row = nullptr;
    const int* order = nullptr;   ///< rows: row of A at each place of P A P^T
};

class SupernodalCholesky {
public:
    /// `a` has the pattern that will be factorised.
    SupernodalCholesky(const SupernodalPattern& pattern, const BlockMatrix& a);

    /// False when the matrix is not positive definite to single precision. The same bits for any number of threads.
    bool factorise(const BlockMatrix& a);

    /// Frees the factor and what a factorisation works in; the next one takes them again.
    void free_values();

    /// x = A^-1 b to about six digits, by the last factor, which must be there. The same bits for any number of threads.
    void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x);

private:
    using Dense = Eigen::Map<Eigen::MatrixXf, 0, Eigen::OuterStride<>>;

    /// Supernodes first .. last, descendants of the last and nobody else's.
    struct Subtree {
        int first, last;
        Eigen::VectorXf beyond; ///< what it takes off the columns shared with others in a solve
    };
    /// The updates that wait for their parents: the last come first.
    struct Stack {
        std::size_t size = 0; ///< that it needs
        std::vector<float> room;
        std::size_t top = 0;
    };

    int columns(int s) const { return first_[s + 1] - first_[s]; }
    int height(int s) const { return row_begin_[s + 1] - row_begin_[s]; }
    std::size_t update_size(int s) const;
    Dense block(int s);
    void find_tree();
    void find_subtrees();
    void find_places(const BlockMatrix& a);
    void size_stacks();
    void add_update(int child, const float* update, int s, float* parent_update);
    bool factor_columns(int s, float* update, bool alone);
    bool eliminate_in_subtree(int s, Stack& stack);
    bool eliminate_shared(int s);
    void solve_columns(int s, Eigen::VectorXf& rest);
    void forward_in_subtree(int s, Subtree& subtree);
    void forward_shared(int s);
    void backward(int s);

    int rows_ = 0;
    std::vector<int> first_, row_begin_, row_, order_;
    std::vector<int> value_begin_;
    std::vector<int> parent_;                ///< of each supernode, -1 at a root
    std::vector<std::vector<int>> children_; ///< rising
    std::vector<int> in_parent_;  ///< beside row_: place of a row below the columns among the rows of the parent
    std::vector<int> place_;      ///< of every value of A among the values of L
    std::vector<float> value_;
    std::vector<Subtree> subtrees_;
    std::vector<std::vector<int>> shared_; ///< supernodes of no subtree: those of a level stand on earlier levels alone
    std::vector<int> all_shared_;          ///< the same, rising
    std::vector<int> shared_index_;        ///< per column: place among the columns of `all_shared_`, or -1
    std::vector<Stack> stacks_;            ///< of each subtree
    std::vector<std::vector<float>> shared_update_; ///< of each shared supernode whose parent has yet to be eliminated
    std::vector<const float*> waiting_;    ///< update of each supernode whose parent has yet to be eliminated
    std::vector<Eigen::VectorXf> rest_;    ///< what a shared supernode takes off the rows below it in a solve
    Eigen::VectorXf x_;
};

} // namespace toile
