// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/implicit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr double hold_share = 100; // of the nodes' own entries in the matrix, with which touches hold
constexpr double stuck = 1e-5;     // m/s, below which a touch does not slide
constexpr double stopping = 0.5;   // of its speed, that friction takes from a node in a step near its stop
constexpr int most_rounds = 2;     // solves of a step, until every touch that slides or pulls is known

/// What a touch resists the rate of its places with in the solve, kg: along the normal and along the face.
struct Hold {
    double normal = 0, along = 0;

    Mat3 matrix(const Vec3& n) const {
        return along * Mat3::Identity() + (normal - along) * n * n.transpose();
    }
};

Vec3 along_face(const Touch& t, const Vec3& v) { return v - v.dot(t.normal) * t.normal; }

/// Cuts the force to what friction can bear; returns whether it had to.
bool cut_to_cone(Touch& t, double coefficient) {
    const double normal = t.force.dot(t.normal);
    const Vec3 along = along_face(t, t.force);
    if (along.norm() <= coefficient * normal) return false;
    t.force = normal * t.normal + coefficient * normal / along.norm() * along;
    return true;
}

struct Step {
    NodeProblem& problem;
    Response& response;
    Moving& cloth;
    const Points& body_end;
    Cholesky& factor;
    bool& analysed;
    int& factorisations;
    const StepOptions& options;

    int n = problem.points();
    double dt = options.time_step;
    Points body_start = response.body();
    std::vector<Hold> hold = {}; ///< of each touch
    double friction = response.options().body_friction;

    double mass(int i) const { return problem.mass()[3 * i]; }
    bool pinned(int i) const { return problem.pinned()[i]; }

    /// Rate of the vector between the places that touch.
    Vec3 rate(const Touch& t, const Points& v) const {
        Vec3 sum = Vec3::Zero();
        for (int k = 0; k < 4; ++k) {
            const int i = t.point[k];
            if (t.weight[k] != 0) sum += t.weight[k] * (i < n ? v[i] : Vec3((body_end[i - n] - body_start[i - n]) / dt));
        }
        return sum;
    }

    /// The velocities by the cloth's own forces and by what contact did in the last step; touches that pull are let go
    /// on the way, and those that friction does not hold slide.
    Points candidate() {
        problem.arrive(cloth.x);
        VectorXd g;
        problem.gradient(cloth.x, g);
        bool pattern_changed = false;
        BlockMatrix& a = problem.hessian(cloth.x, false, pattern_changed);
        if (!analysed || pattern_changed) factor.analyse(a, analysed);
        analysed = true;
        // All by dt2: the second derivative as the problem has it.
        a.add_to_diagonal((1 + options.damping * dt) / (dt * dt) * problem.mass());
        problem.add_damping_matrix(cloth.x, 1 / dt, a);
        VectorXd momentum = problem.mass().cwiseProduct(flat(cloth.velocity)) - dt * g;
        for (int i = 0; i < n; ++i) momentum.segment<3>(3 * i) += dt * cloth.other_force[i];
        find_holds(a);
        Points v(n);
        for (int round = 0; round < most_rounds; ++round) {
            BlockMatrix held = a;
            VectorXd b = momentum;
            for (std::size_t k = 0; k < cloth.touches.size(); ++k) add_hold(cloth.touches[k].touch, hold[k], held, b);
            for (int i = 0; i < n; ++i)
                if (pinned(i)) b.segment<3>(3 * i).setZero();
            held.pin(problem.pinned());
            ++factorisations;
            if (!factor.factorise(held)) throw std::runtime_error("the motion of the cloth has no finite stiffness");
            VectorXd solution;
            factor.solve(b / (dt * dt), solution);
            flat(v) = solution;
            if (!let_go(v, round + 1 == most_rounds)) break;
        }
        return v;
    }

    void find_holds(const BlockMatrix& a) {
        const std::vector<int>& column = a.scalar_columns();
        hold.clear();
        for (HeldTouch& h : cloth.touches) {
            double compliance = 0, mobility = 0;
            for (int k = 0; k < 4; ++k) {
                const int i = h.touch.point[k];
                if (i >= n || pinned(i)) continue;
                double trace = 0;
                for (int c = 0; c < 3; ++c) trace += a.values()[column[3 * i + c]];
                mobility += h.touch.weight[k] * h.touch.weight[k] / mass(i);
                compliance += 3 * h.touch.weight[k] * h.touch.weight[k] / trace;
            }
            const double most = compliance > 0 ? hold_share * dt * dt / compliance : 0;
            hold.push_back({most, most});
            h.began = false;
            if (!h.slides) continue;
            // Near its stop, friction is a damper that gives Coulomb's force at the speed of the last step: the force
            // itself, whose direction turns at once, would keep the cloth moving to and fro.
            const Vec3 sliding = along_face(h.touch, rate(h.touch, cloth.velocity));
            const double normal = h.touch.force.dot(h.touch.normal), damper = dt * friction * normal / sliding.norm();
            h.touch.force = normal * h.touch.normal;
            const bool far_from_stop = damper * mobility < stopping;
            hold.back().along = far_from_stop ? 0 : std::min(most, damper);
            if (far_from_stop) h.touch.force -= damper / dt * sliding;
        }
    }

    void add_hold(const Touch& t, const Hold& hold, BlockMatrix& a, VectorXd& b) const {
        const Mat3 held = hold.matrix(t.normal);
        Vec3 body = Vec3::Zero(); // the part of the rate that is the body's
        for (int k = 0; k < 4; ++k)
            if (const int i = t.point[k]; i >= n && t.weight[k] != 0)
                body += t.weight[k] * (body_end[i - n] - body_start[i - n]) / dt;
        for (int k = 0; k < 4; ++k) {
            const int i = t.point[k];
            if (i >= n) continue;
            b.segment<3>(3 * i) += t.weight[k] * (dt * t.force - held * body);
            for (int l = 0; l < 4; ++l) {
                const int j = t.point[l];
                if (j > i || j >= n) continue;
                const Mat3 block = t.weight[k] * t.weight[l] / (dt * dt) * held;
                if (i == j)
                    a.add_diagonal(i, block);
                else
                    a.add_off_diagonal(j, a.find(i, j), block); // of one edge or triangle, which the cloth couples
            }
        }
    }

    /// Lets go what would pull at these velocities, and lets slide what friction does not hold; returns whether
    /// something changed and the velocities have to be found anew. If not, or when this is the last time, the forces
    /// are brought up to date.
    bool let_go(const Points& v, bool last) {
        bool changed = false;
        std::vector<HeldTouch> kept;
        std::vector<Hold> kept_hold;
        std::vector<Vec3> force;
        for (std::size_t k = 0; k < cloth.touches.size(); ++k) {
            HeldTouch h = cloth.touches[k];
            Touch now = h.touch;
            now.force -= hold[k].matrix(now.normal) / dt * rate(now, v);
            if (!(now.force.dot(now.normal) > 0)) {
                changed = true;
                continue;
            }
            if (!now.welded && cut_to_cone(now, friction) && !h.slides) {
                h.slides = h.began = changed = true;
                h.touch.force = now.force; // friction until the next step
                hold[k].along = 0;
            }
            kept.push_back(h);
            kept_hold.push_back(hold[k]);
            force.push_back(now.force);
        }
        cloth.touches = std::move(kept);
        hold = std::move(kept_hold);
        if (changed && !last) return true;
        for (std::size_t k = 0; k < cloth.touches.size(); ++k) {
            HeldTouch& h = cloth.touches[k];
            if (h.slides && !h.began) h.slides = along_face(h.touch, rate(h.touch, v)).norm() > stuck;
            h.touch.force = force[k];
        }
        return false;
    }

    /// Adds what the response did to what held the cloth already. A touch lasts while its pair is near, a weld until
    /// it pulls.
    void take_up(const ResponseDone& done, const Points& v) {
        std::vector<HeldTouch> all;
        auto old = cloth.touches.begin();
        const auto keep_weld = [&] {
            if (old->touch.welded) all.push_back(*old);
            ++old;
        };
        for (const Touch& now : done.touches) {
            while (old != cloth.touches.end() && before(old->touch, now)) keep_weld();
            HeldTouch h{now};
            if (old != cloth.touches.end() && !before(now, old->touch)) {
                h.touch.force += old->touch.force;
                h.slides = old->slides;
                h.began = old->began;
                ++old;
            } else {
                h.slides = h.began = !now.welded && along_face(now, rate(now, v)).norm() > stuck;
            }
            if (h.touch.force.dot(h.touch.normal) > 0) all.push_back(h);
        }
        while (old != cloth.touches.end()) keep_weld();
        cloth.touches = std::move(all);
        const Points last = std::move(cloth.other_force);
        cloth.other_force = done.other_force;
        if (response.known_at_start()) return;
        for (int i = 0; i < n; ++i) { // impacts of a single step are no lasting force
            Vec3& f = cloth.other_force[i];
            const double most = std::max(2 * last[i].norm(), 9.81 * mass(i));
            if (f.norm() > most) f *= most / f.norm();
        }
    }
};

} // namespace

ResponseDone ImplicitStepper::step(Moving& cloth, const Points& body_end) {
    const std::size_t n = cloth.x.size();
    const double dt = options_.time_step;
    cloth.velocity.resize(n, Vec3::Zero());
    cloth.other_force.resize(n, Vec3::Zero());
    Step one{problem_, response_, cloth, body_end, factor_, analysed_, factorisations_, options_};
    const std::vector<double> inverse = inverse_mass();
    const ResponseStep seen{dt, cloth.x, cloth.velocity, inverse, body_end};
    ResponseDone done;
    Points v = cloth.velocity;
    if (response_.known_at_start()) {
        done = respond(cloth, response_, seen, v);
        one.take_up(done, v);
        v = one.candidate();
        constrain(cloth, v);
        slow(v, dt, options_.max_motion);
    } else {
        v = one.candidate();
        constrain(cloth, v);
        for (std::size_t i = 0; i < n; ++i) // what the response is to do anew
            v[i] -= dt * inverse[i] * cloth.other_force[i];
        slow(v, dt, options_.max_motion);
        done = respond(cloth, response_, seen, v);
        one.take_up(done, v);
    }
    for (std::size_t i = 0; i < n; ++i) cloth.x[i] += dt * v[i];
    cloth.velocity = std::move(v);
    return done;
}

} // namespace toile
