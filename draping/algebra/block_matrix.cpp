// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/algebra/block_matrix.h"

#include "geometry/parallel.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>

namespace toile {

BlockMatrix::BlockMatrix(int block_rows, const std::vector<std::pair<int, int>>& pairs) {
    std::vector<std::uint64_t> keys; // column, row: sorts as the layout runs
    keys.reserve(pairs.size() + block_rows);
    for (const auto& p : pairs) {
        const auto [low, high] = std::minmax(p.first, p.second);
        keys.push_back(std::uint64_t(low) << 32 | std::uint64_t(high));
    }
    for (int i = 0; i < block_rows; ++i) keys.push_back(std::uint64_t(i) << 32 | std::uint64_t(i));
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());

    column_.assign(block_rows + 1, 0);
    for (const auto k : keys) ++column_[(k >> 32) + 1];
    for (int j = 0; j < block_rows; ++j) column_[j + 1] += column_[j];
    row_.reserve(keys.size());
    for (const auto k : keys) row_.push_back(int(k & 0xffffffffu));

    scalar_column_.reserve(3 * block_rows + 1);
    scalar_column_.push_back(0);
    scalar_row_.reserve(9 * keys.size());
    for (int j = 0; j < block_rows; ++j)
        for (int c = 0; c < 3; ++c) {
            for (int slot = column_[j]; slot < column_[j + 1]; ++slot)
                for (int r = slot == column_[j] ? c : 0; r < 3; ++r) scalar_row_.push_back(3 * row_[slot] + r);
            scalar_column_.push_back(int(scalar_row_.size()));
        }
    value_.assign(scalar_row_.size(), 0.0);
}

int BlockMatrix::find(int i, int j) const {
    const auto begin = row_.begin() + column_[j], end = row_.begin() + column_[j + 1];
    const auto it = std::lower_bound(begin, end, i);
    return it != end && *it == i ? int(it - row_.begin()) : -1;
}

void BlockMatrix::set_zero() { std::fill(value_.begin(), value_.end(), 0.0); }

void BlockMatrix::add_to_diagonal(const Eigen::VectorXd& d) {
    for (int k = 0; k < rows(); ++k) value_[scalar_column_[k]] += d[k];
}

void BlockMatrix::pin(const std::vector<char>& pinned) {
    for (int j = 0; j < block_rows(); ++j)
        for (int slot = column_[j]; slot < column_[j + 1]; ++slot) {
            if (!pinned[j] && !pinned[row_[slot]]) continue;
            const bool diagonal = slot == column_[j];
            for (int c = 0; c < 3; ++c) {
                double* column = column_data(j, slot, c);
                for (int r = diagonal ? c : 0; r < 3; ++r) column[r] = diagonal && r == c ? 1.0 : 0.0;
            }
        }
}

void BlockMatrix::multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
    assert(x.size() == rows());
    // Every part of the columns has its own sum, so that the total has one order whatever the number of threads.
    constexpr int parts = 4;
    std::array<Eigen::VectorXd, parts> sums;
    parallel_for(parts, 1, [&](int part_begin, int part_end) {
        for (int part = part_begin; part < part_end; ++part) {
            Eigen::VectorXd& sum = sums[part];
            sum.setZero(rows());
            for (int k = rows() * part / parts; k < rows() * (part + 1) / parts; ++k) {
                const double xk = x[k];
                const int begin = scalar_column_[k], end = scalar_column_[k + 1];
                double own = value_[begin] * xk;
                for (int e = begin + 1; e < end; ++e) {
                    const int r = scalar_row_[e];
                    sum[r] += value_[e] * xk;
                    own += value_[e] * x[r];
                }
                sum[k] += own;
            }
        }
    });
    y = (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

} // namespace toile
