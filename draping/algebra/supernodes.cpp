// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/algebra/supernodes.h"

#include "geometry/parallel.h"

#include <cblas.h>

#include <algorithm>
#include <atomic>
#include <cstring>

extern "C" void spotrf_(const char* triangle, const int* n, float* a, const int* stride, int* failed, std::size_t);

namespace toile {

namespace {

constexpr int most_subtrees = 16;
constexpr int panel = 64;            // columns of a large update that are computed at once
constexpr int many_panels = 256;     // columns from which an update is shared between threads
constexpr int blas_pays = 4096;      // values of a block from which a call of BLAS is cheaper than the plain loop

} // namespace

SupernodalCholesky::SupernodalCholesky(const SupernodalPattern& p, const BlockMatrix& a)
    : rows_(p.rows), first_(p.first, p.first + p.count + 1), row_begin_(p.row_begin, p.row_begin + p.count + 1),
      row_(p.row, p.row + p.row_begin[p.count]), order_(p.order, p.order + p.rows),
      value_begin_(p.value_begin, p.value_begin + p.count + 1), shared_update_(p.count), waiting_(p.count, nullptr),
      rest_(p.count), x_(p.rows) {
    find_tree();
    find_subtrees();
    find_places(a);
    size_stacks();
}

std::size_t SupernodalCholesky::update_size(int s) const {
    const std::size_t below = height(s) - columns(s);
    return below * below;
}

SupernodalCholesky::Dense SupernodalCholesky::block(int s) {
    return Dense(value_.data() + value_begin_[s], height(s), columns(s), Eigen::OuterStride<>(height(s)));
}

void SupernodalCholesky::find_tree() {
    const int n = int(first_.size()) - 1;
    std::vector<int> owner(rows_), place(rows_);
    for (int s = 0; s < n; ++s)
        for (int c = first_[s]; c < first_[s + 1]; ++c) owner[c] = s;
    parent_.assign(n, -1);
    children_.assign(n, {});
    in_parent_.assign(row_.size(), -1);
    for (int s = 0; s < n; ++s) {
        const int below = row_begin_[s] + columns(s);
        if (below == row_begin_[s + 1]) continue;
        parent_[s] = owner[row_[below]];
        children_[parent_[s]].push_back(s);
    }
    for (int s = 0; s < n; ++s) {
        for (int i = row_begin_[s]; i < row_begin_[s + 1]; ++i) place[row_[i]] = i - row_begin_[s];
        for (const int c : children_[s])
            for (int i = row_begin_[c] + columns(c); i < row_begin_[c + 1]; ++i) in_parent_[i] = place[row_[i]];
    }
}

// Cuts the elimination tree from the roots down, always its heaviest subtree, until there are enough.
void SupernodalCholesky::find_subtrees() {
    const int n = int(first_.size()) - 1;
    std::vector<int> low(n), open, height_above(n, -1); // of shared supernodes above the subtrees
    std::vector<double> cost(n);
    for (int s = 0; s < n; ++s) {
        low[s] = s;
        cost[s] = double(height(s)) * height(s) * columns(s);
        for (const int c : children_[s]) {
            cost[s] += cost[c];
            low[s] = std::min(low[s], low[c]);
        }
        if (parent_[s] < 0) open.push_back(s);
    }
    while (int(open.size()) < most_subtrees) {
        const auto heaviest = std::max_element(open.begin(), open.end(),
                                               [&](int a, int b) { return cost[a] < cost[b]; });
        const int s = *heaviest;
        if (children_[s].empty()) break;
        open.erase(heaviest);
        open.insert(open.end(), children_[s].begin(), children_[s].end());
        all_shared_.push_back(s);
    }
    std::sort(all_shared_.begin(), all_shared_.end());
    shared_index_.assign(rows_, -1);
    int shared_columns = 0;
    for (const int s : all_shared_) {
        for (const int c : children_[s]) height_above[s] = std::max(height_above[s], height_above[c]);
        if (++height_above[s] == int(shared_.size())) shared_.emplace_back();
        shared_[height_above[s]].push_back(s);
        for (int c = first_[s]; c < first_[s + 1]; ++c) shared_index_[c] = shared_columns++;
    }
    std::sort(open.begin(), open.end());
    // Supernodes are numbered in postorder: a subtree is a range.
    for (const int s : open) subtrees_.push_back({low[s], s, Eigen::VectorXf(shared_columns)});
}

void SupernodalCholesky::find_places(const BlockMatrix& a) {
    std::vector<int> inverse(rows_), owner(rows_);
    for (int k = 0; k < rows_; ++k) inverse[order_[k]] = k;
    for (int s = 0; s + 1 < int(first_.size()); ++s)
        for (int c = first_[s]; c < first_[s + 1]; ++c) owner[c] = s;
    place_.resize(a.values().size());
    parallel_for(rows_, 256, [&](int begin, int end) {
        for (int j = begin; j < end; ++j)
            for (int e = a.scalar_columns()[j]; e < a.scalar_columns()[j + 1]; ++e) {
                const auto [column, row] = std::minmax(inverse[j], inverse[a.scalar_rows()[e]]);
                const int s = owner[column];
                const auto rows = row_.begin() + row_begin_[s];
                const int at = int(std::lower_bound(rows, row_.begin() + row_begin_[s + 1], row) - rows);
                place_[e] = value_begin_[s] + (column - first_[s]) * height(s) + at;
            }
    });
}

// A supernode's update is made above those of its children, which it then replaces.
void SupernodalCholesky::size_stacks() {
    for (const Subtree& subtree : subtrees_) {
        std::size_t top = 0, most = 0;
        for (int s = subtree.first; s <= subtree.last; ++s) {
            most = std::max(most, top + update_size(s));
            for (const int c : children_[s]) top -= update_size(c);
            top += update_size(s);
        }
        stacks_.emplace_back().size = most;
    }
}

// Adds a child's update to the columns and the update of its parent.
void SupernodalCholesky::add_update(int child, const float* update, int s, float* parent_update) {
    const int n = height(child) - columns(child), wide = columns(s), tall = height(s), below = tall - wide;
    const int* to = in_parent_.data() + row_begin_[child] + columns(child);
    float* own = value_.data() + value_begin_[s];
    for (int j = 0; j < n; ++j) {
        const float* from = update + std::size_t(j) * n;
        if (to[j] < wide) {
            float* column = own + std::size_t(to[j]) * tall;
            for (int i = j; i < n; ++i) column[to[i]] += from[i];
        } else {
            float* column = parent_update + std::size_t(to[j] - wide) * below;
            for (int i = j; i < n; ++i) column[to[i] - wide] += from[i];
        }
    }
}

/// Factors the columns of a supernode, to which its children have been added, and takes what they are worth off its
/// update. `alone`: other threads have nothing else to do.
bool SupernodalCholesky::factor_columns(int s, float* update, bool alone) {
    const int wide = columns(s), tall = height(s), below = tall - wide;
    Dense own = block(s);
    int failed = 0;
    spotrf_("L", &wide, own.data(), &tall, &failed, 1);
    if (failed != 0) return false;
    if (below == 0) return true; // a root: there may be others
    float* lower = own.data() + wide;
    cblas_strsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, below, wide, 1, own.data(), tall,
                lower, tall);
    if (!alone || below < many_panels) {
        cblas_ssyrk(CblasColMajor, CblasLower, CblasNoTrans, below, wide, -1, lower, tall, 1, update, below);
        return true;
    }
    parallel_for(below, panel, [&](int begin, int end) {
        cblas_sgemm(CblasColMajor, CblasNoTrans, CblasTrans, below - begin, end - begin, wide, -1, lower + begin,
                    tall, lower + begin, tall, 1, update + std::size_t(begin) * below + begin, below);
    });
    return true;
}

bool SupernodalCholesky::eliminate_in_subtree(int s, Stack& stack) {
    float* update = stack.room.data() + stack.top;
    std::fill_n(update, update_size(s), 0.0f);
    std::size_t bottom = stack.top;
    for (const int c : children_[s]) {
        add_update(c, waiting_[c], s, update);
        bottom = std::min(bottom, std::size_t(waiting_[c] - stack.room.data()));
    }
    if (!factor_columns(s, update, false)) return false;
    float* rest = stack.room.data() + bottom;
    if (rest != update) std::memmove(rest, update, update_size(s) * sizeof(float));
    waiting_[s] = rest;
    stack.top = bottom + update_size(s);
    return true;
}

bool SupernodalCholesky::eliminate_shared(int s) {
    std::vector<float>& update = shared_update_[s];
    update.assign(update_size(s), 0.0f);
    for (const int c : children_[s]) {
        add_update(c, waiting_[c], s, update.data());
        std::vector<float>().swap(shared_update_[c]);
    }
    waiting_[s] = update.data();
    return factor_columns(s, update.data(), true);
}

bool SupernodalCholesky::factorise(const BlockMatrix& a) {
    value_.resize(value_begin_.back());
    parallel_for(int(value_.size()), 1 << 16,
                 [&](int begin, int end) { std::fill(value_.begin() + begin, value_.begin() + end, 0.0f); });
    parallel_for(int(place_.size()), 1 << 14, [&](int begin, int end) {
        for (int e = begin; e < end; ++e) value_[place_[e]] = float(a.values()[e]);
    });
    std::atomic<bool> definite = true;
    parallel_for(int(subtrees_.size()), 1, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) {
            stacks_[k].top = 0;
            stacks_[k].room.resize(stacks_[k].size);
            for (int s = subtrees_[k].first; s <= subtrees_[k].last && definite; ++s)
                if (!eliminate_in_subtree(s, stacks_[k])) definite = false;
        }
    });
    for (const std::vector<int>& level : shared_)
        parallel_for(int(level.size()), 1, [&](int begin, int end) {
            for (int k = begin; k < end && definite; ++k)
                if (!eliminate_shared(level[k])) definite = false;
        });
    return definite;
}

void SupernodalCholesky::free_values() {
    std::vector<float>().swap(value_);
    for (Stack& stack : stacks_) std::vector<float>().swap(stack.room);
    for (std::vector<float>& update : shared_update_) std::vector<float>().swap(update);
}

/// Solves for the columns of a supernode; `rest` receives what that takes off the rows below.
void SupernodalCholesky::solve_columns(int s, Eigen::VectorXf& rest) {
    const int wide = columns(s), below = height(s) - wide;
    const Dense block = this->block(s);
    auto own = x_.segment(first_[s], wide);
    rest.resize(below);
    if (block.size() < blas_pays) {
        block.topRows(wide).triangularView<Eigen::Lower>().solveInPlace(own);
        rest.noalias() = block.bottomRows(below) * own;
    } else {
        cblas_strsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, wide, block.data(), height(s), own.data(), 1);
        cblas_sgemv(CblasColMajor, CblasNoTrans, below, wide, 1, block.data() + wide, height(s), own.data(), 1, 0,
                    rest.data(), 1);
    }
}

void SupernodalCholesky::forward_in_subtree(int s, Subtree& subtree) {
    Eigen::VectorXf rest;
    solve_columns(s, rest);
    const int* row = row_.data() + row_begin_[s] + columns(s);
    const int end = first_[subtree.last + 1];
    for (int i = 0; i < rest.size(); ++i)
        (row[i] < end ? x_[row[i]] : subtree.beyond[shared_index_[row[i]]]) -= rest[i];
}

/// Takes what the subtrees, and then the shared supernodes before it, have for its columns, in one order always.
void SupernodalCholesky::forward_shared(int s) {
    auto own = x_.segment(first_[s], columns(s));
    for (const Subtree& t : subtrees_) own += t.beyond.segment(shared_index_[first_[s]], columns(s));
    for (const int before : all_shared_) {
        if (before >= s) break;
        const auto begin = row_.begin() + row_begin_[before] + columns(before), end = row_.begin() + row_begin_[before + 1];
        for (auto row = std::lower_bound(begin, end, first_[s]); row != end && *row < first_[s + 1]; ++row)
            x_[*row] -= rest_[before][row - begin];
    }
    solve_columns(s, rest_[s]);
}

void SupernodalCholesky::backward(int s) {
    const int wide = columns(s), below = height(s) - wide;
    const Dense block = this->block(s);
    auto own = x_.segment(first_[s], wide);
    Eigen::VectorXf rest(below);
    const int* row = row_.data() + row_begin_[s] + wide;
    for (int i = 0; i < below; ++i) rest[i] = x_[row[i]];
    if (block.size() < blas_pays) {
        own.noalias() -= block.bottomRows(below).transpose() * rest;
        block.topRows(wide).triangularView<Eigen::Lower>().transpose().solveInPlace(own);
    } else {
        cblas_sgemv(CblasColMajor, CblasTrans, below, wide, -1, block.data() + wide, height(s), rest.data(), 1, 1,
                    own.data(), 1);
        cblas_strsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, wide, block.data(), height(s), own.data(), 1);
    }
}

void SupernodalCholesky::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) {
    // Single precision has a narrow range of exponents.
    const double scale = b.cwiseAbs().maxCoeff();
    x.setZero(rows_);
    if (!(scale > 0)) return;
    for (int k = 0; k < rows_; ++k) x_[k] = float(b[order_[k]] / scale);
    parallel_for(int(subtrees_.size()), 1, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) {
            subtrees_[k].beyond.setZero();
            for (int s = subtrees_[k].first; s <= subtrees_[k].last; ++s) forward_in_subtree(s, subtrees_[k]);
        }
    });
    const auto for_level = [this](const std::vector<int>& level, void (SupernodalCholesky::*step)(int)) {
        parallel_for(int(level.size()), 1, [&](int begin, int end) {
            for (int k = begin; k < end; ++k) (this->*step)(level[k]);
        });
    };
    for (const auto& level : shared_) for_level(level, &SupernodalCholesky::forward_shared);
    for (auto level = shared_.rbegin(); level != shared_.rend(); ++level) for_level(*level, &SupernodalCholesky::backward);
    parallel_for(int(subtrees_.size()), 1, [&](int begin, int end) {
        for (int k = begin; k < end; ++k)
            for (int s = subtrees_[k].last; s >= subtrees_[k].first; --s) backward(s);
    });
    for (int k = 0; k < rows_; ++k) x[order_[k]] = scale * double(x_[k]);
}

} // namespace toile
