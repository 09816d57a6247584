// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// How goals change with the amounts of alterations, the drape following: one linear solve whatever their number.
// With g(x, p) = 0 at rest, dJ/dp = dJ/dp|x - lambda . dg/dp|x, K lambda = dJ/dx. The derivatives at fixed x go through rest
// lengths, stencils of bending, masses and strains; they are central differences of J - lambda . g along each amount, which
// no solve enters.

#include "draping/fit/altered_drape.h"
#include "draping/fit/goal.h"

namespace toile {

/// Derivative of value(goals) by the amounts, at rest at `x`. False when the state is no minimum.
bool fit_gradient(AlteredDrape& drape, const std::vector<FitGoal>& goals, const Eigen::VectorXd& amounts, const Points& x,
                  Eigen::VectorXd& gradient);

} // namespace toile
