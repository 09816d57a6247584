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
      value_begin_(p.value_begin, p.value_begin + p.count + 1), value_(p.value_begin[p.count]),
      waiting_(p.count, nullptr), x_(p.rows) {
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
    std::vector<int> low(n), open;
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
        shared_.push_back(s);
    }
    std::sort(shared_.begin(), shared_.end());
    std::sort(open.begin(), open.end());
    shared_index_.assign(rows_, -1);
    int shared_columns = 0;
    for (const int s : shared_)
        for (int c = first_[s]; c < first_[s + 1]; ++c) shared_index_[c] = shared_columns++;
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
    stacks_.resize(subtrees_.size() + 1);
    const auto size = [&](Stack& stack, const auto& supernodes, const auto& on_stack) {
        std::size_t top = 0, most = 0;
        for (const int s : supernodes) {
            most = std::max(most, top + update_size(s));
            for (const int c : children_[s])
                if (on_stack(c)) top -= update_size(c);
            top += update_size(s);
        }
        stack.room.resize(most);
    };
    for (std::size_t k = 0; k < subtrees_.size(); ++k) {
        std::vector<int> range;
        for (int s = subtrees_[k].first; s <= subtrees_[k].last; ++s) range.push_back(s);
        size(stacks_[k], range, [](int) { return true; });
    }
    size(stacks_.back(), shared_, [&](int c) { return std::binary_search(shared_.begin(), shared_.end(), c); });
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

bool SupernodalCholesky::eliminate(int s, Stack& stack, bool in_subtree) {
    const int wide = columns(s), tall = height(s), below = tall - wide;
    float* update = stack.room.data() + stack.top;
    std::fill_n(update, update_size(s), 0.0f);
    std::size_t bottom = stack.top;
    for (const int c : children_[s]) {
        add_update(c, waiting_[c], s, update);
        if (in_subtree || shared_index_[first_[c]] >= 0) // else it lies on the stack of a subtree
            bottom = std::min(bottom, std::size_t(waiting_[c] - stack.room.data()));
    }
    Dense own = block(s);
    int failed = 0;
    spotrf_("L", &wide, own.data(), &tall, &failed, 1);
    if (failed != 0) return false;
    if (below == 0) { // a root: there may be others
        stack.top = bottom;
        return true;
    }
    float* lower = own.data() + wide;
    cblas_strsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, below, wide, 1, own.data(), tall,
                lower, tall);
    if (!in_subtree && below >= many_panels) {
        parallel_for(below, panel, [&](int begin, int end) {
            cblas_sgemm(CblasColMajor, CblasNoTrans, CblasTrans, below - begin, end - begin, wide, -1, lower + begin,
                        tall, lower + begin, tall, 1, update + std::size_t(begin) * below + begin, below);
        });
    } else {
        cblas_ssyrk(CblasColMajor, CblasLower, CblasNoTrans, below, wide, -1, lower, tall, 1, update, below);
    }
    float* rest = stack.room.data() + bottom;
    if (rest != update) std::memmove(rest, update, update_size(s) * sizeof(float));
    waiting_[s] = rest;
    stack.top = bottom + update_size(s);
    return true;
}

bool SupernodalCholesky::factorise(const BlockMatrix& a) {
    parallel_for(int(value_.size()), 1 << 16,
                 [&](int begin, int end) { std::fill(value_.begin() + begin, value_.begin() + end, 0.0f); });
    parallel_for(int(place_.size()), 1 << 14, [&](int begin, int end) {
        for (int e = begin; e < end; ++e) value_[place_[e]] = float(a.values()[e]);
    });
    std::atomic<bool> definite = true;
    parallel_for(int(subtrees_.size()), 1, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) {
            stacks_[k].top = 0;
            for (int s = subtrees_[k].first; s <= subtrees_[k].last && definite; ++s)
                if (!eliminate(s, stacks_[k], true)) definite = false;
        }
    });
    stacks_.back().top = 0;
    for (const int s : shared_)
        if (!definite || !eliminate(s, stacks_.back(), false)) return false;
    return definite;
}

void SupernodalCholesky::take(const double* values) {
    parallel_for(int(value_.size()), 1 << 16, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) value_[i] = float(values[i]);
    });
}

void SupernodalCholesky::forward(int s, Subtree* subtree) {
    const int wide = columns(s), below = height(s) - wide;
    const Dense block = this->block(s);
    auto own = x_.segment(first_[s], wide);
    Eigen::VectorXf rest(below);
    if (block.size() < blas_pays) {
        block.topRows(wide).triangularView<Eigen::Lower>().solveInPlace(own);
        rest.noalias() = block.bottomRows(below) * own;
    } else {
        cblas_strsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, wide, block.data(), height(s), own.data(), 1);
        cblas_sgemv(CblasColMajor, CblasNoTrans, below, wide, 1, block.data() + wide, height(s), own.data(), 1, 0,
                    rest.data(), 1);
    }
    const int* row = row_.data() + row_begin_[s] + wide;
    const int end = subtree ? first_[subtree->last + 1] : rows_;
    for (int i = 0; i < below; ++i) {
        if (row[i] < end)
            x_[row[i]] -= rest[i];
        else
            subtree->beyond[shared_index_[row[i]]] -= rest[i];
    }
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
