// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/explicit.h"

#include "geometry/text.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr double margin = 0.93;   // of the sharp bound, which is found from its wrong side and moves within a step
constexpr double shorter = 0.9;   // times a substep that turned out too long
constexpr double blown_up = 20;   // times the largest motion of a step: slowing must not hide what grows without bounds

bool is_finite(const Points& x) {
    return std::all_of(x.begin(), x.end(), [](const Vec3& p) { return p.allFinite(); });
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

double ExplicitStepper::stable_substep(const Points& x) { return margin * fastest(problem_, x, &fastest_).step(); }

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

void ExplicitStepper::go_on(const Moving& cloth, const Points& body_velocity, Motion& m) {
    const int n = problem_.points();
    const double h = options_.time_step / count_;
    const std::vector<double> inverse = inverse_mass();
    m = {cloth.x, cloth.velocity, Points(cloth.touches.size(), Vec3::Zero())};
    VectorXd g, friction;
    begin_step(cloth.x);
    for (int k = 0; k < count_; ++k) {
        problem_.arrive(m.x);
        problem_.gradient(m.x, g);
        problem_.damping(m.x, m.v, friction);
        for (int i = 0; i < n; ++i) {
            const Vec3 force = (friction - g).segment<3>(3 * i) + lasting(cloth, i);
            m.v[i] = (m.v[i] + h * inverse[i] * force) / (1 + options_.damping * h);
        }
        hold_touches(cloth, m.v, body_velocity, m.impulse);
        for (int i = 0; i < n; ++i) m.x[i] += h * m.v[i];
        constrain(m.x, m.v, h);
    }
}

ResponseDone ExplicitStepper::step(Moving& cloth, const Points& body_end) {
    const int n = problem_.points();
    const double dt = options_.time_step;
    cloth.velocity.resize(n, Vec3::Zero());
    const Points body_velocity = body_velocities(response_, body_end, dt);

    if (stable_ == 0) stable_ = stable_substep(cloth.x);
    double wanted = substep > 0 ? substep : stable_;
    Motion m;
    for (;;) {
        count_ = std::max(1, int(std::ceil(dt / wanted - 1e-9)));
        go_on(cloth, body_velocity, m);
        if (substep > 0 || !is_finite(m.x)) break;
        stable_ = stable_substep(m.x);
        if (dt / count_ <= stable_) break;
        wanted = std::min(stable_, shorter * dt / count_); // the cloth became stiffer on its way
    }
    Points mean(n);
    for (int i = 0; i < n; ++i) mean[i] = (m.x[i] - cloth.x[i]) / dt;
    for (int i = 0; i < n; ++i)
        if (!(dt * mean[i].norm() < blown_up * options_.max_motion && std::isfinite(m.v[i].squaredNorm())))
            throw std::runtime_error(text("the motion of the cloth blew up: its explicit steps are %.3g s long, and stable up to "
                                          "about %.3g s",
                                          dt / count_, stable_));
    std::vector<HeldTouch> held = cloth.touches;
    for (std::size_t k = 0; k < held.size(); ++k) held[k].touch.force = m.impulse[k] / dt;
    const ResponseDone done =
        go(cloth, response_, inverse_mass(), body_end, options_, std::move(mean), std::move(m.v));
    add_held(cloth.touches, held);
    return done;
}

} // namespace toile
