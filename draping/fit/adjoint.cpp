// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fit/adjoint.h"

namespace toile {

namespace {

constexpr double goal_step = 1e-7;  // m of an alteration: goals may have corners
constexpr double along_step = 1e-4; // of a motion of the nodes, m per m

Eigen::VectorXd pull_of(const std::vector<FitGoal>& goals, const Garment& garment, const Points& x) {
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(3 * Eigen::Index(x.size()));
    add_gradient(goals, garment, x, pull);
    return pull;
}

} // namespace

bool fit_gradient(AlteredDrape& drape, const std::vector<FitGoal>& goals, const Eigen::VectorXd& amounts, const Points& x,
                  Eigen::VectorXd& gradient) {
    Eigen::VectorXd lambda;
    if (!drape.solve(amounts, x, pull_of(goals, drape.garment_at(amounts), x), lambda)) return false;
    gradient = -drape.force_slopes(amounts, x).transpose() * lambda;
    for (Eigen::Index k = 0; k < amounts.size(); ++k) {
        Eigen::VectorXd low = amounts, high = amounts;
        low[k] -= goal_step;
        high[k] += goal_step;
        gradient[k] += (value(goals, drape.garment_at(high), x) - value(goals, drape.garment_at(low), x)) / (2 * goal_step);
    }
    return true;
}

bool fit_curvature(AlteredDrape& drape, const std::vector<FitGoal>& goals, const Eigen::VectorXd& amounts, const Points& x,
                   Eigen::MatrixXd& curvature) {
    const Eigen::MatrixXd slopes = drape.force_slopes(amounts, x);
    const Garment garment = drape.garment_at(amounts);
    Eigen::MatrixXd way(slopes.rows(), slopes.cols()), pull(slopes.rows(), slopes.cols());
    for (Eigen::Index k = 0; k < slopes.cols(); ++k) {
        Eigen::VectorXd d;
        if (!drape.solve(amounts, x, -slopes.col(k), d)) return false;
        Points low = x, high = x;
        flat(low) -= along_step * d;
        flat(high) += along_step * d;
        way.col(k) = d;
        pull.col(k) = (pull_of(goals, garment, high) - pull_of(goals, garment, low)) / (2 * along_step);
    }
    const Eigen::MatrixXd product = way.transpose() * pull;
    curvature = 0.5 * (product + product.transpose());
    return true;
}

} // namespace toile
