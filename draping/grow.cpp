// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/grow.h"

#include <algorithm>
#include <limits>

namespace toile {

namespace {

constexpr double grow_distance = 2e-3; // m, contact distance while the body grows
constexpr double grow_share = 0.5; // of the way to the cloth that the body takes at once, lest it get stuck there
constexpr double grow_gain = 0.03; // share of the way left that counts as nearer

} // namespace

double farthest(const Points& a, const Points& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
    return most;
}

ContactOptions while_growing(const ContactOptions& at_rest) {
    ContactOptions wide = at_rest;
    wide.body.distance = std::max(at_rest.body.distance, grow_distance);
    wide.body.stiffness *= at_rest.body.distance / wide.body.distance;
    return wide;
}

double grow_body(ClothProblem& problem, const Points& full, const Points& x, int patience,
                 const std::function<bool(const SettleOptions&)>& settle) {
    Contact& contact = problem.contact();
    SettleOptions o;
    o.tolerance = 1;
    o.max_iterations = 3;
    o.exact_below = 0;
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(3 * problem.points());
    double left = std::numeric_limits<double>::infinity(); // m
    for (int waited = 0; waited < patience; ++waited) {
        Points motion(full.size());
        for (std::size_t v = 0; v < motion.size(); ++v) motion[v] = full[v] - contact.body()[v];
        const double longest = farthest(full, contact.body());
        if (longest < (1 - grow_gain) * left) {
            left = longest;
            waited = 0;
        }
        const double part = longest > 0 ? std::min(1.0, 2 * contact.options().body.distance / longest) : 1;
        for (Vec3& m : motion) m *= part;
        contact.prepare(x, still, &motion);
        double t = contact.feasible_step(x, still, &motion);
        if (t < 1) t *= grow_share;
        const bool grown = part * t == 1;
        Points next = contact.body();
        for (std::size_t v = 0; v < motion.size(); ++v) next[v] = grown ? full[v] : Vec3(next[v] + t * motion[v]);
        contact.set_body(next);
        const bool goes_on = settle(o);
        if (grown || !goes_on) break;
    }
    return farthest(full, contact.body());
}

} // namespace toile
