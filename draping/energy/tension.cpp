// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/tension.h"

#include <algorithm>
#include <cmath>

namespace toile {

double violation(const LengthConstraint& c, double length, const Points& x) {
    return ((x[c.b] - x[c.a]).squaredNorm() - length * length) / (2 * c.length);
}

double strain(const LengthConstraint& c, const Points& x) { return (x[c.b] - x[c.a]).norm() / c.length - 1; }

Tension::Tension(std::vector<LengthConstraint> lines)
    : newtons(lines.size(), 0.0), stiffness(lines.size(), 0.0), lines_(std::move(lines)) {
    for (const LengthConstraint& c : lines_) target.push_back(c.length);
}

double Tension::value(const Points& x) const {
    double sum = 0;
    for (std::size_t k = 0; k < lines_.size(); ++k) {
        const double c = violated(int(k), x);
        sum += newtons[k] * c + 0.5 * stiffness[k] * c * c;
    }
    return sum;
}

void Tension::add_gradient(const Points& x, Eigen::VectorXd& g) const {
    for (std::size_t k = 0; k < lines_.size(); ++k) {
        const Vec3 pull = (newtons[k] + stiffness[k] * violated(int(k), x)) * slope(lines_[k], x);
        g.segment<3>(3 * lines_[k].a) -= pull;
        g.segment<3>(3 * lines_[k].b) += pull;
    }
}

void Tension::couplings(std::vector<std::pair<int, int>>& pairs) const {
    for (const LengthConstraint& c : lines_) pairs.emplace_back(c.a, c.b);
}

void Tension::add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const {
    for (std::size_t k = 0; k < lines_.size(); ++k) {
        const Vec3 s = slope(lines_[k], x);
        double pull = newtons[k] + stiffness[k] * violated(int(k), x);
        if (kind == HessianKind::projected) pull = std::max(pull, 0.0);
        const auto [low, high] = std::minmax(lines_[k].a, lines_[k].b);
        const Mat3 block = pull / lines_[k].length * Mat3::Identity() + stiffness[k] * s * s.transpose();
        h.add_diagonal(low, block);
        h.add_diagonal(high, block);
        h.add_off_diagonal(low, h.find(high, low), -block);
    }
}

bool Tension::take_up(const Points& x) {
    double most = 0;
    for (std::size_t k = 0; k < lines_.size(); ++k) {
        const double c = violated(int(k), x);
        newtons[k] += stiffness[k] * c;
        most = std::max(most, std::abs(c) / lines_[k].length);
    }
    return most > kept;
}

} // namespace toile
