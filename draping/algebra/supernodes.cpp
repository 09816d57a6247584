// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/algebra/supernodes.h"

#include "geometry/parallel.h"

#include <Eigen/Dense>

#include <algorithm>

namespace toile {

namespace {

constexpr int most_subtrees = 16;

using Block = Eigen::Map<const Eigen::MatrixXf>;

} // namespace

SupernodalSolver::SupernodalSolver(const SupernodalFactor& f)
    : rows_(f.rows), first_(f.first, f.first + f.count + 1), row_begin_(f.row_begin, f.row_begin + f.count + 1),
      row_(f.row, f.row + f.row_begin[f.count]), order_(f.order, f.order + f.rows),
      value_begin_(f.value_begin, f.value_begin + f.count + 1), value_(f.value_begin[f.count]), x_(f.rows) {
    parallel_for(int(value_.size()), 1 << 16, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) value_[i] = float(f.value[i]);
    });
    find_subtrees();
}

// Cuts the elimination tree from the roots down, always its heaviest subtree, until there are enough.
void SupernodalSolver::find_subtrees() {
    const int n = int(first_.size()) - 1;
    std::vector<int> owner(rows_), low(n);
    for (int s = 0; s < n; ++s)
        for (int c = first_[s]; c < first_[s + 1]; ++c) owner[c] = s;
    std::vector<double> cost(n);
    std::vector<std::vector<int>> children(n);
    std::vector<int> open;
    for (int s = 0; s < n; ++s) {
        low[s] = s;
        cost[s] += double(value_begin_[s + 1] - value_begin_[s]);
        for (int c : children[s]) {
            cost[s] += cost[c];
            low[s] = std::min(low[s], low[c]);
        }
        const int next = row_begin_[s] + first_[s + 1] - first_[s]; // first row below the diagonal block
        if (next < row_begin_[s + 1])
            children[owner[row_[next]]].push_back(s);
        else
            open.push_back(s);
    }
    while (int(open.size()) < most_subtrees) {
        const auto heaviest = std::max_element(open.begin(), open.end(),
                                               [&](int a, int b) { return cost[a] < cost[b]; });
        const int s = *heaviest;
        if (children[s].empty()) break;
        open.erase(heaviest);
        open.insert(open.end(), children[s].begin(), children[s].end());
        shared_.push_back(s);
    }
    std::sort(shared_.begin(), shared_.end());
    std::sort(open.begin(), open.end());
    shared_index_.assign(rows_, -1);
    int columns = 0;
    for (int s : shared_)
        for (int c = first_[s]; c < first_[s + 1]; ++c) shared_index_[c] = columns++;
    // Supernodes are numbered in postorder: a subtree is a range.
    for (int s : open) subtrees_.push_back({low[s], s, Eigen::VectorXf(columns)});
}

void SupernodalSolver::forward(int s, Subtree* subtree) {
    const int columns = first_[s + 1] - first_[s], rows = row_begin_[s + 1] - row_begin_[s];
    const Block block(value_.data() + value_begin_[s], rows, columns);
    auto own = x_.segment(first_[s], columns);
    block.topRows(columns).triangularView<Eigen::Lower>().solveInPlace(own);
    if (rows == columns) return;
    const Eigen::VectorXf below = block.bottomRows(rows - columns) * own;
    const int* row = row_.data() + row_begin_[s] + columns;
    const int end = subtree ? first_[subtree->last + 1] : rows_;
    for (int i = 0; i < rows - columns; ++i) {
        if (row[i] < end)
            x_[row[i]] -= below[i];
        else
            subtree->beyond[shared_index_[row[i]]] -= below[i];
    }
}

void SupernodalSolver::backward(int s) {
    const int columns = first_[s + 1] - first_[s], rows = row_begin_[s + 1] - row_begin_[s];
    const Block block(value_.data() + value_begin_[s], rows, columns);
    auto own = x_.segment(first_[s], columns);
    if (rows > columns) {
        Eigen::VectorXf below(rows - columns);
        const int* row = row_.data() + row_begin_[s] + columns;
        for (int i = 0; i < rows - columns; ++i) below[i] = x_[row[i]];
        own.noalias() -= block.bottomRows(rows - columns).transpose() * below;
    }
    block.topRows(columns).triangularView<Eigen::Lower>().transpose().solveInPlace(own);
}

void SupernodalSolver::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) {
    // Single precision has a narrow range of exponents.
    const double scale = b.cwiseAbs().maxCoeff();
    x.setZero(rows_);
    if (!(scale > 0)) return;
    for (int k = 0; k < rows_; ++k) x_[k] = float(b[order_[k]] / scale);
    parallel_for(int(subtrees_.size()), 1, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) {
            subtrees_[k].beyond.setZero();
            for (int s = subtrees_[k].first; s <= subtrees_[k].last; ++s) forward(s, &subtrees_[k]);
        }
    });
    for (const Subtree& t : subtrees_)
        for (int s : shared_)
            for (int c = first_[s]; c < first_[s + 1]; ++c) x_[c] += t.beyond[shared_index_[c]];
    for (int s : shared_) forward(s, nullptr);
    for (auto s = shared_.rbegin(); s != shared_.rend(); ++s) backward(*s);
    parallel_for(int(subtrees_.size()), 1, [&](int begin, int end) {
        for (int k = begin; k < end; ++k)
            for (int s = subtrees_[k].last; s >= subtrees_[k].first; --s) backward(s);
    });
    for (int k = 0; k < rows_; ++k) x[order_[k]] = scale * double(x_[k]);
}

} // namespace toile
