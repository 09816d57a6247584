// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/nonconforming/saddle.h"

#include <algorithm>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr double penalty_factor = 1e3; // over the largest entry of W
constexpr int most_rounds = 12;
constexpr double enough = 1e-10;

} // namespace

Saddle::Saddle(const Eigen::SparseMatrix<double>& stiffness, Bars bars, std::vector<char> held)
    : bars_(std::move(bars)), held_(std::move(held)) {
    std::vector<std::pair<int, int>> pairs;
    for (int j = 0; j < stiffness.outerSize(); ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator e(stiffness, j); e; ++e)
            if (e.row() > e.col()) pairs.emplace_back(int(e.row()), int(e.col()));
    for (const Bar& bar : bars_)
        pairs.emplace_back(bar.a, bar.b);
    matrix_ = BlockMatrix(int(stiffness.rows()), pairs);
    for (int j = 0; j < stiffness.outerSize(); ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator e(stiffness, j); e; ++e)
            slot_of_entry_.push_back(e.row() > e.col() ? matrix_.find(int(e.row()), int(e.col())) : -1);
    for (const Bar& bar : bars_)
        slot_of_bar_.push_back(matrix_.find(std::max(bar.a, bar.b), std::min(bar.a, bar.b)));
    factor_.analyse(matrix_);
}

bool Saddle::factorise(const Eigen::SparseMatrix<double>& stiffness, double shift, const Points& x,
                       const VectorXd& lambda) {
    at_ = x;
    matrix_.set_zero();
    double largest = shift;
    std::size_t entry = 0;
    for (int j = 0; j < stiffness.outerSize(); ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator e(stiffness, j); e; ++e, ++entry) {
            if (e.row() == e.col()) {
                matrix_.add_diagonal(j, (e.value() + shift) * Mat3::Identity());
                largest = std::max(largest, e.value() + shift);
            } else if (e.row() > e.col()) {
                matrix_.add_off_diagonal(j, slot_of_entry_[entry], e.value() * Mat3::Identity());
            }
        }
    for (std::size_t i = 0; i < bars_.size(); ++i)
        largest = std::max(largest, std::abs(lambda[i]) / bars_[i].length);
    penalty_ = penalty_factor * largest;
    for (std::size_t i = 0; i < bars_.size(); ++i) {
        const Bar& bar = bars_[i];
        const Vec3 row = (x[bar.a] - x[bar.b]) / bar.length;
        const Mat3 block = penalty_ * row * row.transpose() + lambda[i] / bar.length * Mat3::Identity();
        matrix_.add_diagonal(bar.a, block);
        matrix_.add_diagonal(bar.b, block);
        matrix_.add_off_diagonal(std::min(bar.a, bar.b), slot_of_bar_[i], -block);
    }
    matrix_.pin(held_);
    ++factorisations_;
    return factor_.factorise(matrix_);
}

void Saddle::clear_held(VectorXd& v) const {
    for (std::size_t i = 0; i < held_.size(); ++i)
        if (held_[i]) v.segment<3>(3 * i).setZero();
}

bool Saddle::solve(const VectorXd& g, const VectorXd& c, VectorXd& d, VectorXd& y) {
    y.setZero(c.size());
    double first = 0;
    for (int round = 0; round < most_rounds; ++round) {
        VectorXd right = -g, conditions = -y - penalty_ * c;
        add_tensions(bars_, at_, conditions, right);
        clear_held(right);
        factor_.solve(right, d);
        const VectorXd left = lengthening(bars_, at_, d) + c;
        y += penalty_ * left;
        const double size = left.norm();
        if (round == 0) first = std::max(size, c.norm());
        if (size <= enough * first) return true;
    }
    return false;
}

void Saddle::restore(const VectorXd& c, VectorXd& d) {
    VectorXd right = VectorXd::Zero(3 * at_.size());
    add_tensions(bars_, at_, -penalty_ * c, right);
    clear_held(right);
    factor_.solve(right, d);
}

} // namespace toile
