// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/node_problem.h"

#include <algorithm>

namespace toile {

NodeProblem::NodeProblem(std::vector<double> node_mass)
    : pinned_(node_mass.size(), 0) {
    set_node_mass(std::move(node_mass));
}

void NodeProblem::set_node_mass(std::vector<double> node_mass) {
    node_mass_ = std::move(node_mass);
    mass_.resize(3 * Eigen::Index(node_mass_.size()));
    double sum = 0;
    for (int i = 0; i < points(); ++i) {
        mass_.segment<3>(3 * i).setConstant(node_mass_[i]);
        sum += node_mass_[i];
    }
    least_mass_ = 0.1 * sum / points();
}

double NodeProblem::residual(const Points& x, const Eigen::VectorXd& g) {
    double worst = 0;
    for (int i = 0; i < points(); ++i) {
        if (pinned_[i]) continue;
        const double force = g.segment<3>(3 * i).norm() + unanswered(x, i);
        const double r = force / (9.81 * std::max(node_mass_[i], least_mass_));
        if (r > worst) {
            worst = r;
            worst_ = i;
        }
    }
    return worst;
}

void NodeProblem::clear_pinned(Eigen::VectorXd& g) const {
    for (int i = 0; i < points(); ++i)
        if (pinned_[i]) g.segment<3>(3 * i).setZero();
}

} // namespace toile
