// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/free_cloth.h"

#include <algorithm>

namespace toile {

FreeCloth::FreeCloth(std::unique_ptr<Energy> energy, std::vector<double> node_mass, bool projected)
    : NodeProblem(std::move(node_mass)), energy_(std::move(energy)), projected_(projected) {
    renew_energy();
}

void FreeCloth::renew_energy() {
    std::vector<std::pair<int, int>> pairs;
    energy_->couplings(pairs);
    for (auto& [a, b] : pairs)
        if (a > b) std::swap(a, b);
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    if (pairs != cloth_couplings_) matrix_made_ = false;
    cloth_couplings_ = std::move(pairs);
    if (matrix_made_) energy_->find_blocks(matrix_);
}

double FreeCloth::value(const Points& x) { return energy_->value(x) + toile::value(*this, node_mass_, x); }

void FreeCloth::gradient(const Points& x, Eigen::VectorXd& g) {
    g.setZero(3 * points());
    energy_->add_gradient(x, g);
    toile::add_gradient(*this, node_mass_, x, g);
    clear_pinned(g);
}

void FreeCloth::make_pattern() {
    std::vector<std::pair<int, int>> pairs = cloth_couplings_;
    couplings(*this, pairs);
    more_couplings(pairs);
    matrix_ = BlockMatrix(points(), pairs);
    energy_->find_blocks(matrix_);
    matrix_made_ = true;
}

BlockMatrix& FreeCloth::hessian(const Points& x, bool exact, bool& pattern_changed) {
    for (;;) {
        if (!matrix_made_) {
            make_pattern();
            pattern_changed = true;
        }
        matrix_.set_zero();
        if (add_more_hessian(x, exact, matrix_)) break;
        matrix_made_ = false;
    }
    energy_->add_hessian(x, exact || !projected_ ? HessianKind::exact : HessianKind::projected, matrix_);
    add_hessian(*this, x, matrix_);
    matrix_at_ = x;
    return matrix_;
}

void FreeCloth::multiply(const Eigen::VectorXd& v, Eigen::VectorXd& product) const {
    matrix_.multiply(v, product);
    energy_->add_left_out(matrix_at_, v, product);
    for (int i = 0; i < points(); ++i)
        if (pinned_[i]) product.segment<3>(3 * i) = v.segment<3>(3 * i);
}

void FreeCloth::curvature_along(const Points& x, const Eigen::VectorXd& g, const Eigen::VectorXd& d, Eigen::VectorXd& hd) {
    constexpr double part = 1e-3; // of steps of millimetres
    Points near = x;
    flat(near) += part * d;
    gradient(near, hd);
    hd = (hd - g) / part;
}

double FreeCloth::feasible_step(const Points& x, const Eigen::VectorXd&, std::vector<double>* shares) {
    if (shares) shares->assign(x.size(), 1.0);
    return 1;
}

void FreeCloth::damping(const Points& x, const Points& v, Eigen::VectorXd& force) {
    force.setZero(3 * points());
    energy_->add_damping(x, v, force);
}

void FreeCloth::add_damping_matrix(const Points& x, double factor, BlockMatrix& h) {
    energy_->add_damping_matrix(x, factor, h);
}

} // namespace toile
