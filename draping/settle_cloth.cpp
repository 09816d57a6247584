// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/settle_cloth.h"

#include <algorithm>

namespace toile {

namespace {

constexpr double first_taken_up = 5; // residual from which constraints of cloth with points of its own take up forces

} // namespace

bool has_own_points(const ClothProblem& problem) { return problem.points() > problem.contact().node_count(); }

SettleResult settle_cloth(ClothProblem& problem, Points& nodes, Cholesky& factor, SettleOptions options) {
    Points all = problem.all_points(nodes);
    if (options.progress)
        options.progress = [&, goes_on = options.progress](int iteration, double residual) {
            std::copy_n(all.begin(), nodes.size(), nodes.begin());
            return goes_on(iteration, residual);
        };
    const SettleResult r = settle(problem, all, factor, options);
    nodes = problem.keep(std::move(all));
    return r;
}

SettleResult settle_constrained(ClothProblem& problem, Points& nodes, const SettleOptions& options,
                                const std::function<SettleResult(const SettleOptions&)>& settle) {
    TakeUpOptions how;
    how.first = has_own_points(problem) ? first_taken_up : 0;
    return settle_and_take_up(settle, [&] { return problem.take_up(problem.all_points(nodes)); }, options, how);
}

} // namespace toile
