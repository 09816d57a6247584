// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/explicit.h"

#include "draping/solve/stability.h"
#include "geometry/text.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr double margin = 0.93;   // of the sharp bound, which is found from its wrong side and moves within a step
constexpr double renewed = 0.01;  // change of the safe bound, from which on the sharp one is found again
constexpr double blown_up = 1000; // times the largest motion of a step, from which on it is no motion any more

/// The rate of the vector between the places that touch.
Vec3 rate(const Touch& t, const Points& v, const Points& body_velocity) {
    Vec3 sum = Vec3::Zero();
    const int n = int(v.size());
    for (int k = 0; k < 4; ++k)
        if (t.weight[k] != 0) sum += t.weight[k] * (t.point[k] < n ? v[t.point[k]] : body_velocity[t.point[k] - n]);
    return sum;
}

/// What the response did, with what held the cloth in the substeps.
void add_held(std::vector<HeldTouch>& touches, const std::vector<HeldTouch>& held) {
    auto old = held.begin();
    for (HeldTouch& now : touches) {
        while (old != held.end() && before(old->touch, now.touch)) ++old;
        if (old == held.end()) return;
        if (!before(now.touch, old->touch)) now.touch.force += old->touch.force;
    }
}

} // namespace

double ExplicitStepper::stable_substep(const Points& x) {
    const double safe = gershgorin(problem_, x).step();
    if (!(std::abs(safe - safe_) <= renewed * safe_)) {
        safe_ = safe;
        stable_ = std::max(safe, margin * lanczos(problem_, x).step());
    }
    return stable_;
}

void ExplicitStepper::hold_touches(const Moving& cloth, Points& v, const Points& body_velocity, Points& impulse) const {
    const int n = int(v.size());
    const double friction = response_.options().body_friction;
    for (std::size_t k = 0; k < cloth.touches.size(); ++k) {
        const Touch& t = cloth.touches[k].touch;
        double mobility = 0; // 1/kg
        for (int c = 0; c < 4; ++c)
            if (t.point[c] < n && !pinned(t.point[c]))
                mobility += t.weight[c] * t.weight[c] / problem_.node_mass()[t.point[c]];
        const Vec3 speed = rate(t, v, body_velocity);
        const double normal = speed.dot(t.normal);
        if (mobility == 0 || normal >= 0) continue;
        const Vec3 along = speed - normal * t.normal;
        const double most = t.welded ? 1 : std::min(1.0, friction * -normal / std::max(along.norm(), 1e-300));
        const Vec3 given = (-normal * t.normal - most * along) / mobility;
        impulse[k] += given;
        for (int c = 0; c < 4; ++c)
            if (t.point[c] < n && !pinned(t.point[c])) v[t.point[c]] += t.weight[c] / problem_.node_mass()[t.point[c]] * given;
    }
}

ResponseDone ExplicitStepper::step(Moving& cloth, const Points& body_end) {
    const int n = problem_.points();
    const double dt = options_.time_step;
    cloth.velocity.resize(n, Vec3::Zero());
    const double stable = stable_substep(cloth.x), wanted = substep > 0 ? substep : stable;
    count_ = std::max(1, int(std::ceil(dt / wanted - 1e-9)));
    const double h = dt / count_;

    Points x = cloth.x, v = cloth.velocity, body_velocity(body_end.size());
    for (std::size_t i = 0; i < body_end.size(); ++i) body_velocity[i] = (body_end[i] - response_.body()[i]) / dt;
    const std::vector<double> inverse = inverse_mass();
    Points impulse(cloth.touches.size(), Vec3::Zero());
    VectorXd g, friction;
    begin_step(cloth.x);
    for (int k = 0; k < count_; ++k) {
        problem_.arrive(x);
        problem_.gradient(x, g);
        problem_.damping(x, v, friction);
        for (int i = 0; i < n; ++i)
            v[i] = (v[i] + h * inverse[i] * (friction - g).segment<3>(3 * i)) / (1 + options_.damping * h);
        hold_touches(cloth, v, body_velocity, impulse);
        for (int i = 0; i < n; ++i) x[i] += h * v[i];
        constrain(x, v, h);
    }
    Points mean(n);
    for (int i = 0; i < n; ++i) {
        mean[i] = (x[i] - cloth.x[i]) / dt;
        if (!(dt * mean[i].norm() < blown_up * options_.max_motion && std::isfinite(v[i].squaredNorm())))
            throw std::runtime_error(text("the motion of the cloth blew up: its explicit steps are %.3g s long, and stable up to "
                                          "about %.3g s",
                                          h, stable));
    }
    std::vector<HeldTouch> held = cloth.touches;
    for (std::size_t k = 0; k < held.size(); ++k) held[k].touch.force = impulse[k] / dt;
    const ResponseDone done = go(cloth, response_, inverse, body_end, options_, std::move(mean), std::move(v));
    add_held(cloth.touches, held);
    return done;
}

} // namespace toile
