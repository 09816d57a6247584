// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/held_touches.h"

#include <algorithm>

namespace toile {

namespace {

constexpr double stuck = 1e-5;   // m/s, below which a touch does not slide
constexpr double stopping = 0.5; // of its speed, that friction takes from a node in a step near its stop

Vec3 along_face(const Touch& t, const Vec3& v) { return v - v.dot(t.normal) * t.normal; }

/// Cuts the force to what friction can bear; returns whether it had to.
bool cut_to_cone(Touch& t, double coefficient) {
    const double normal = t.force.dot(t.normal);
    const Vec3 along = along_face(t, t.force);
    if (along.norm() <= coefficient * normal) return false;
    t.force = normal * t.normal + coefficient * normal / along.norm() * along;
    return true;
}

} // namespace

HeldTouches::HeldTouches(Moving& cloth, const Response& response, const std::vector<double>& inverse_mass,
                         const Points& body_end, double time_step)
    : cloth_(cloth), inverse_mass_(inverse_mass), body_velocity_(body_velocities(response, body_end, time_step)), dt_(time_step),
      friction_(response.options().body_friction), known_at_start_(response.known_at_start()) {}

Mat3 HeldTouches::Hold::matrix(const Vec3& n) const {
    return along * Mat3::Identity() + (normal - along) * n * n.transpose();
}

void HeldTouches::find_holds(const std::vector<double>& stiffness, double share) {
    hold_.clear();
    for (HeldTouch& h : cloth_.touches) {
        double compliance = 0, mobility = 0;
        for (int k = 0; k < 4; ++k) {
            const int i = h.touch.point[k];
            if (!is_node(i) || inverse_mass_[i] == 0) continue;
            mobility += h.touch.weight[k] * h.touch.weight[k] * inverse_mass_[i];
            compliance += h.touch.weight[k] * h.touch.weight[k] / stiffness[i];
        }
        const double most = compliance > 0 ? share * dt_ * dt_ / compliance : 0;
        hold_.push_back({most, most});
        h.began = false;
        if (!h.slides) continue;
        // Near its stop, friction is a damper that gives Coulomb's force at the speed of the last step: the force
        // itself, whose direction turns at once, would keep the cloth moving to and fro.
        const Vec3 sliding = along_face(h.touch, rate(h.touch, cloth_.velocity, body_velocity_));
        const double normal = h.touch.force.dot(h.touch.normal), damper = dt_ * friction_ * normal / sliding.norm();
        h.touch.force = normal * h.touch.normal;
        const bool far_from_stop = damper * mobility < stopping;
        hold_.back().along = far_from_stop ? 0 : std::min(most, damper);
        if (far_from_stop) h.touch.force -= damper / dt_ * sliding;
    }
}

void HeldTouches::add(BlockMatrix& a, Eigen::VectorXd& momentum) const {
    for (std::size_t touch = 0; touch < cloth_.touches.size(); ++touch) {
        const Touch& t = cloth_.touches[touch].touch;
        const Mat3 held = hold_[touch].matrix(t.normal);
        Vec3 body = Vec3::Zero(); // the part of the rate that is the body's
        for (int k = 0; k < 4; ++k)
            if (!is_node(t.point[k]) && t.weight[k] != 0) body += t.weight[k] * body_velocity_[t.point[k] - int(inverse_mass_.size())];
        for (int k = 0; k < 4; ++k) {
            const int i = t.point[k];
            if (!is_node(i)) continue;
            momentum.segment<3>(3 * i) += t.weight[k] * (dt_ * t.force - held * body);
            for (int l = 0; l < 4; ++l) {
                const int j = t.point[l];
                if (j > i || !is_node(j)) continue;
                const Mat3 block = t.weight[k] * t.weight[l] / (dt_ * dt_) * held;
                if (i == j)
                    a.add_diagonal(i, block);
                else
                    a.add_off_diagonal(j, a.find(i, j), block); // of one edge or triangle, which the cloth couples
            }
        }
    }
}

bool HeldTouches::let_go(const Points& v, bool last) {
    bool changed = false;
    std::vector<HeldTouch> kept;
    std::vector<Hold> kept_hold;
    std::vector<Vec3> force;
    for (std::size_t k = 0; k < cloth_.touches.size(); ++k) {
        HeldTouch h = cloth_.touches[k];
        Touch now = h.touch;
        now.force -= hold_[k].matrix(now.normal) / dt_ * rate(now, v, body_velocity_);
        if (!(now.force.dot(now.normal) > 0)) {
            changed = true;
            continue;
        }
        if (!now.welded && cut_to_cone(now, friction_) && !h.slides) {
            h.slides = h.began = changed = true;
            h.touch.force = now.force; // friction until the next step
            hold_[k].along = 0;
        }
        kept.push_back(h);
        kept_hold.push_back(hold_[k]);
        force.push_back(now.force);
    }
    cloth_.touches = std::move(kept);
    hold_ = std::move(kept_hold);
    if (changed && !last) return true;
    for (std::size_t k = 0; k < cloth_.touches.size(); ++k) {
        HeldTouch& h = cloth_.touches[k];
        if (h.slides && !h.began) h.slides = along_face(h.touch, rate(h.touch, v, body_velocity_)).norm() > stuck;
        h.touch.force = force[k];
    }
    return false;
}

void HeldTouches::take_up(const ResponseDone& done, const Points& v) {
    std::vector<HeldTouch> all;
    auto old = cloth_.touches.begin();
    const auto keep_weld = [&] {
        if (old->touch.welded) all.push_back(*old);
        ++old;
    };
    for (const Touch& now : done.touches) {
        while (old != cloth_.touches.end() && before(old->touch, now)) keep_weld();
        HeldTouch h{now};
        if (old != cloth_.touches.end() && !before(now, old->touch)) {
            h.touch.force += old->touch.force;
            h.slides = old->slides;
            h.began = old->began;
            ++old;
        } else {
            h.slides = h.began = !now.welded && along_face(now, rate(now, v, body_velocity_)).norm() > stuck;
        }
        if (h.touch.force.dot(h.touch.normal) > 0) all.push_back(h);
    }
    while (old != cloth_.touches.end()) keep_weld();
    cloth_.touches = std::move(all);
    const Points last = std::move(cloth_.other_force);
    cloth_.other_force = done.other_force;
    if (known_at_start_) return;
    for (std::size_t i = 0; i < cloth_.other_force.size(); ++i) { // impacts of a single step are no lasting force
        Vec3& f = cloth_.other_force[i];
        const double most = std::max(2 * last[i].norm(), inverse_mass_[i] > 0 ? 9.81 / inverse_mass_[i] : 0.0);
        if (f.norm() > most) f *= most / f.norm();
    }
}

ResponseDone step_with_touches(Moving& cloth, Response& response, const std::vector<double>& inverse_mass, const Points& body_end,
                               const StepOptions& options, const std::function<Points(HeldTouches&)>& solve, Points& v) {
    const std::size_t n = cloth.x.size();
    const double dt = options.time_step;
    cloth.velocity.resize(n, Vec3::Zero());
    cloth.other_force.resize(n, Vec3::Zero());
    HeldTouches touches(cloth, response, inverse_mass, body_end, dt);
    const ResponseStep seen{dt, cloth.x, cloth.velocity, inverse_mass, body_end};
    ResponseDone done;
    if (response.known_at_start()) {
        v = cloth.velocity;
        done = respond(cloth, response, seen, v);
        touches.take_up(done, v);
        v = solve(touches);
        slow(v, dt, options.max_motion);
    } else {
        v = solve(touches);
        for (std::size_t i = 0; i < n; ++i) // what the response is to do anew
            v[i] -= dt * inverse_mass[i] * cloth.other_force[i];
        slow(v, dt, options.max_motion);
        done = respond(cloth, response, seen, v);
        touches.take_up(done, v);
    }
    return done;
}

} // namespace toile
