// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fit/adjoint.h"

namespace toile {

namespace {

constexpr double rest_step = 1e-6; // m: strains and bending have twelve digits, and slivers edges of half a millimetre
constexpr double goal_step = 1e-7; // m: goals may have corners

} // namespace

bool fit_gradient(AlteredDrape& drape, const std::vector<FitGoal>& goals, const Eigen::VectorXd& amounts, const Points& x,
                  Eigen::VectorXd& gradient) {
    const Garment here = drape.garment_at(amounts);
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(3 * Eigen::Index(x.size())), solution;
    add_gradient(goals, here, x, pull);
    if (!drape.solve(x, pull, solution)) return false;
    Points lambda(x.size());
    flat(lambda) = solution;
    const RestWork work = drape.work(here, x, lambda);
    const auto garment_near = [&](Eigen::Index k, double by) {
        Eigen::VectorXd near = amounts;
        near[k] += by;
        return drape.garment_at(near);
    };
    gradient.resize(amounts.size());
    for (Eigen::Index k = 0; k < amounts.size(); ++k) {
        const auto goals_at = [&](double by) { return value(goals, garment_near(k, by), x); };
        const auto work_at = [&](double by) { return drape.work(garment_near(k, by), x, lambda); };
        gradient[k] = (goals_at(goal_step) - goals_at(-goal_step)) / (2 * goal_step) -
                      slope(work_at(-rest_step), work, work_at(rest_step), 2 * rest_step);
    }
    return true;
}

} // namespace toile
