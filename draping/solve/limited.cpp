// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/limited.h"

#include <algorithm>

namespace toile {

LimitedStepper::LimitedStepper(std::unique_ptr<NodeProblem> problem, const std::vector<Spring>& springs, Response& response,
                               const StepOptions& options, const LimitOptions& limits)
    : ExplicitStepper(std::move(problem), response, options), limits_(limits) {
    for (const Spring& s : springs)
        if (s.limit > 0 && s.kind != SpringKind::bend && (limits.shear || s.kind != SpringKind::shear))
            springs_.push_back(s);
    if (limits.order == SweepOrder::reversed) std::reverse(springs_.begin(), springs_.end());
}

void LimitedStepper::begin_step(const Points& x) {
    impulse_.assign(x.size(), Vec3::Zero());
    inverse_mass_ = inverse_mass();
    if (limits_.order == SweepOrder::from_top) sort(x);
}

void LimitedStepper::sort(const Points& x) {
    const auto key = [&](const Spring& s) {
        return limits_.order == SweepOrder::from_top ? -std::max(x[s.a].y(), x[s.b].y())
                                                     : -(x[s.b] - x[s.a]).norm() / ((1 + s.limit) * s.length);
    };
    std::stable_sort(springs_.begin(), springs_.end(), [&](const Spring& s, const Spring& t) { return key(s) < key(t); });
}

void LimitedStepper::constrain(Points& x, Points& v, double h) {
    for (int k = 0; k < limits_.sweeps; ++k) {
        if (limits_.order == SweepOrder::longest_first) sort(x);
        sweep(x, v, h);
    }
}

void LimitedStepper::sweep(Points& x, Points& v, double h) {
    for (const Spring& s : springs_) {
        const Vec3 d = x[s.b] - x[s.a];
        const double most = (1 + s.limit) * s.length, distance = d.norm();
        const double mobility = inverse_mass_[s.a] + inverse_mass_[s.b];
        if (distance <= most || mobility == 0) continue;
        const Vec3 impulse = (distance - most) / (h * mobility * distance) * d;
        for (const auto& [node, sign] : {std::pair{s.a, 1.0}, std::pair{s.b, -1.0}}) {
            const Vec3 dv = sign * inverse_mass_[node] * impulse;
            v[node] += dv;
            x[node] += h * dv;
            impulse_[node] += sign * impulse;
        }
    }
}

} // namespace toile
