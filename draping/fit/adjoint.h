// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// How goals change with the amounts of alterations, the drape following. With g(x, p) = 0 at rest,
// dJ/dp = dJ/dp|x - lambda . dg/dp|x, K lambda = dJ/dx: one linear solve whatever the number of alterations.

#include "draping/fit/altered_drape.h"
#include "draping/fit/goal.h"

namespace toile {

/// Derivative of value(goals) by the amounts, at rest at `x`. False when the state is no minimum.
bool fit_gradient(AlteredDrape& drape, const std::vector<FitGoal>& goals, const Eigen::VectorXd& amounts, const Points& x,
                  Eigen::VectorXd& gradient);

/// An estimate of the second derivative, without what bends the way of the nodes (Gauss and Newton's): a solve for each
/// alteration. False when the state is no minimum.
bool fit_curvature(AlteredDrape& drape, const std::vector<FitGoal>& goals, const Eigen::VectorXd& amounts, const Points& x,
                   Eigen::MatrixXd& curvature);

} // namespace toile
