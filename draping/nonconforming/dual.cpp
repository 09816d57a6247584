// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/nonconforming/dual.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr double giving_way = 1e-9; // of the mean of the diagonal

} // namespace

IsometryDual::IsometryDual(int points, Bars bars, const std::vector<HeldPlace>& places)
    : bars_(std::move(bars)), places_(int(places.size())) {
    const int triangles = int(bars_.size()) / 3;
    std::vector<std::map<int, Mat3>> blocks_of(points);
    for (std::size_t i = 0; i < bars_.size(); ++i)
        for (int e : {bars_[i].a, bars_[i].b}) blocks_of[e].emplace(int(i / 3), Mat3::Zero());
    for (int p = 0; p < places_; ++p)
        for (const auto& [e, weight] : places[p]) blocks_of[e].emplace(triangles + p, weight * Mat3::Identity());

    std::vector<std::pair<int, int>> pairs;
    first_.push_back(0);
    for (const auto& blocks : blocks_of) {
        for (const auto& [block, slope] : blocks) {
            for (int k = first_.back(); k < int(entries_.size()); ++k) pairs.emplace_back(block, entries_[k].block);
            entries_.push_back({block, slope});
        }
        first_.push_back(int(entries_.size()));
    }
    const auto entry_of = [&](int e, int block) {
        int k = first_[e];
        while (entries_[k].block != block) ++k;
        return k;
    };
    for (std::size_t i = 0; i < bars_.size(); ++i)
        entries_of_bar_.push_back({entry_of(bars_[i].a, int(i / 3)), entry_of(bars_[i].b, int(i / 3))});
    matrix_ = BlockMatrix(triangles + places_, pairs);
    for (const auto& [i, j] : pairs) slots_.push_back(matrix_.find(i, j));
    factor_.analyse(matrix_);
}

void IsometryDual::linearise(const Points& x) {
    for (std::size_t i = 0; i < bars_.size(); ++i) {
        const Bar& bar = bars_[i];
        const Vec3 slope = (x[bar.a] - x[bar.b]) / bar.length;
        entries_[entries_of_bar_[i][0]].slope.row(i % 3) = slope;
        entries_[entries_of_bar_[i][1]].slope.row(i % 3) = -slope;
    }
}

bool IsometryDual::factorise(const std::vector<Mat3>& mobility) {
    mobility_ = mobility;
    matrix_.set_zero();
    double sum = 0;
    std::size_t slot = 0;
    for (std::size_t e = 0; e < mobility_.size(); ++e)
        for (int i = first_[e]; i < first_[e + 1]; ++i) {
            const Mat3 moved = entries_[i].slope * mobility_[e];
            for (int j = first_[e]; j < i; ++j)
                matrix_.add_off_diagonal(entries_[j].block, slots_[slot++], moved * entries_[j].slope.transpose());
            const Mat3 own = moved * entries_[i].slope.transpose();
            matrix_.add_diagonal(entries_[i].block, own);
            sum += own.trace();
        }
    const double mean = sum / conditions();
    if (!std::isfinite(mean)) return false;
    matrix_.add_to_diagonal(VectorXd::Constant(conditions(), mean > 0 ? giving_way * mean : 1));
    ++factorisations_;
    return factor_.factorise(matrix_);
}

VectorXd IsometryDual::product(const VectorXd& d) const {
    VectorXd c = VectorXd::Zero(conditions());
    for (std::size_t e = 0; e + 1 < first_.size(); ++e)
        for (int i = first_[e]; i < first_[e + 1]; ++i)
            c.segment<3>(3 * entries_[i].block) += entries_[i].slope * d.segment<3>(3 * e);
    return c;
}

VectorXd IsometryDual::transpose_product(const VectorXd& y) const {
    VectorXd r(3 * (first_.size() - 1));
    for (std::size_t e = 0; e + 1 < first_.size(); ++e) {
        Vec3 force = Vec3::Zero();
        for (int i = first_[e]; i < first_[e + 1]; ++i)
            force += entries_[i].slope.transpose() * y.segment<3>(3 * entries_[i].block);
        r.segment<3>(3 * e) = force;
    }
    return r;
}

VectorXd IsometryDual::mobile(const VectorXd& r) const {
    VectorXd d(r.size());
    for (std::size_t e = 0; e < mobility_.size(); ++e) d.segment<3>(3 * e) = mobility_[e] * r.segment<3>(3 * e);
    return d;
}

VectorXd IsometryDual::multipliers(const VectorXd& c) {
    VectorXd y;
    factor_.solve(c, y);
    return y;
}

} // namespace toile
