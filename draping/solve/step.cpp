// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/step.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr double hold_share = 100; // of a node's own entries in the matrix, with which faces hold nodes
constexpr double stuck = 1e-9;     // m/s, below which a node does not slide

/// What holds a node in the solve: along the normal, or in every direction while it does not slide.
Mat3 held_directions(const NodeTouch& t, bool slides) {
    return slides ? Mat3(t.normal * t.normal.transpose()) : Mat3::Identity();
}

/// Friction of a sliding node, against its motion along the face.
Vec3 sliding_friction(const NodeTouch& t, const Vec3& relative, double coefficient) {
    const Vec3 along = relative - relative.dot(t.normal) * t.normal;
    const double speed = along.norm();
    return speed > 0 ? Vec3(-coefficient * std::max(0.0, t.force.dot(t.normal)) / speed * along) : Vec3::Zero();
}

/// A force of contact pushes, and along the face does what friction can.
/// Returns whether friction was asked for more.
bool within_cone(NodeTouch& t, double coefficient) {
    const double normal = t.force.dot(t.normal);
    const Vec3 along = t.force - normal * t.normal;
    if (along.norm() <= coefficient * normal) return false;
    t.force = normal * t.normal + coefficient * normal / along.norm() * along;
    return true;
}

struct Step {
    Problem& problem;
    Response& response;
    Moving& cloth;
    const Points& body_end;
    Cholesky& factor;
    const StepOptions& options;

    int n = problem.points();
    double dt = options.time_step;
    Points body_start = response.body();
    Points face_velocity = {};            ///< per touching node
    std::vector<double> hold = {};        ///< kg per touching node, in the solve

    double mass(int i) const { return problem.mass()[3 * i]; }

    /// The velocities by the cloth's own forces and what contact did in the last step.
    Points candidate() {
        problem.arrive(cloth.x);
        VectorXd b;
        problem.gradient(cloth.x, b);
        b *= -dt;
        b += problem.mass().cwiseProduct(flat(cloth.velocity));
        bool pattern_changed = false;
        BlockMatrix& a = problem.hessian(cloth.x, false, pattern_changed);
        if (!cloth.analysed || pattern_changed) factor.analyse(a, cloth.analysed);
        cloth.analysed = true;
        // A/dt2, since the second derivative belongs to the problem and has no scale of its own.
        a.add_to_diagonal((1 + options.damping * dt) / (dt * dt) * problem.mass());
        const std::vector<double> diagonal = stiffness_of_nodes(a);
        hold.assign(n, 0.0);
        face_velocity.assign(n, Vec3::Zero());
        for (int i = 0; i < n; ++i) {
            if (problem.pinned()[i]) {
                b.segment<3>(3 * i).setZero();
                continue;
            }
            b.segment<3>(3 * i) += dt * cloth.other_force[i];
            NodeTouch& t = cloth.touch[i];
            if (!t.on) continue;
            face_velocity[i] = t.velocity(body_start, body_end, dt);
            if (cloth.slides[i])
                t.force = t.force.dot(t.normal) * t.normal +
                          sliding_friction(t, cloth.velocity[i] - face_velocity[i], response.options().body_friction);
            hold[i] = hold_share * dt * dt * diagonal[i];
            const Mat3 held = held_directions(t, cloth.slides[i]);
            a.add_diagonal(i, hold[i] / (dt * dt) * held);
            b.segment<3>(3 * i) += dt * t.force + hold[i] * held * face_velocity[i];
        }
        a.pin(problem.pinned());
        if (!factor.factorise(a)) throw std::runtime_error("the motion of the cloth has no finite stiffness");
        VectorXd v;
        for (int i = 0; i < n; ++i)
            if (!problem.pinned()[i]) b.segment<3>(3 * i) /= dt * dt;
        factor.solve(b, v);
        Points out(n);
        flat(out) = v;
        return out;
    }

    /// A third of the trace of every diagonal block.
    static std::vector<double> stiffness_of_nodes(const BlockMatrix& a) {
        const std::vector<int>& column = a.scalar_columns();
        std::vector<double> d(a.block_rows());
        for (int i = 0; i < a.block_rows(); ++i)
            for (int c = 0; c < 3; ++c) d[i] += a.values()[column[3 * i + c]] / 3;
        return d;
    }

    /// What held each node by now; what it cannot have been is let go. Takes what else contact did back: that is for
    /// the response to do anew.
    void let_go(Points& v) {
        for (int i = 0; i < n; ++i) {
            if (problem.pinned()[i]) continue;
            const Vec3 relative = v[i] - face_velocity[i];
            v[i] -= dt / mass(i) * cloth.other_force[i];
            NodeTouch& t = cloth.touch[i];
            if (!t.on) continue;
            t.force -= hold[i] / dt * held_directions(t, cloth.slides[i]) * relative;
            if (t.force.dot(t.normal) <= 0) {
                t = {};
                continue;
            }
            if (cloth.slides[i]) {
                const Vec3 before = sliding_friction(t, cloth.velocity[i] - face_velocity[i], 1);
                cloth.slides[i] = sliding_friction(t, relative, 1).dot(before) > 0; // friction has stopped it
            } else {
                cloth.slides[i] = within_cone(t, response.options().body_friction);
            }
        }
    }

    void slow(Points& v) const {
        for (Vec3& u : v) {
            const double far = dt * u.norm();
            if (!std::isfinite(far)) throw std::runtime_error("the motion of the cloth is no longer finite");
            if (far > options.max_motion) u *= options.max_motion / far;
        }
    }

    /// Adds what the response did to what held the nodes already.
    void take_up(const ResponseDone& done, const Points& v) {
        for (int i = 0; i < n; ++i) {
            NodeTouch& t = cloth.touch[i];
            const NodeTouch& now = done.touch[i];
            const bool fresh = !t.on;
            const Vec3 held = t.force;
            t = now;
            if (!t.on) continue;
            t.force += held;
            if (!(t.force.dot(t.normal) > 0)) {
                t.on = false;
            } else if (fresh) {
                const Vec3 relative = v[i] - t.velocity(body_start, body_end, dt);
                cloth.slides[i] = std::isfinite(response.options().body_friction) &&
                                  (relative - relative.dot(t.normal) * t.normal).norm() > stuck;
            }
        }
        const Points last = std::move(cloth.other_force);
        cloth.other_force = done.other_force;
        for (int i = 0; i < n; ++i) { // impacts of a single step are no lasting force
            Vec3& f = cloth.other_force[i];
            const double most = std::max(2 * last[i].norm(), 9.81 * mass(i));
            if (f.norm() > most) f *= most / f.norm();
        }
    }
};

} // namespace

Points Moving::contact_force() const {
    Points force = other_force;
    for (std::size_t i = 0; i < touch.size(); ++i)
        if (touch[i].on) force[i] += touch[i].force;
    return force;
}

ResponseDone step(Problem& problem, Response& response, Moving& cloth, const Points& body_end, Cholesky& factor,
                  const StepOptions& options) {
    const std::size_t n = cloth.x.size();
    cloth.velocity.resize(n, Vec3::Zero());
    cloth.touch.resize(n);
    cloth.slides.resize(n, 0);
    cloth.other_force.resize(n, Vec3::Zero());
    Step one{problem, response, cloth, body_end, factor, options};
    Points v = one.candidate();
    one.let_go(v);
    one.slow(v);
    std::vector<double> inverse_mass(n);
    for (std::size_t i = 0; i < n; ++i) inverse_mass[i] = problem.pinned()[i] ? 0 : 1 / one.mass(int(i));
    ResponseDone done =
        response.respond({options.time_step, cloth.x, cloth.velocity, inverse_mass, body_end}, v);
    one.take_up(done, v);
    for (std::size_t i = 0; i < n; ++i) cloth.x[i] += options.time_step * v[i];
    cloth.velocity = std::move(v);
    return done;
}

double residual(Problem& problem, const Moving& cloth) {
    problem.arrive(cloth.x);
    VectorXd g;
    problem.gradient(cloth.x, g);
    const Points force = cloth.contact_force();
    for (int i = 0; i < problem.points(); ++i)
        if (!problem.pinned()[i]) g.segment<3>(3 * i) -= force[i];
    return problem.residual(cloth.x, g);
}

double kinetic_energy(const Problem& problem, const Moving& cloth) {
    return 0.5 * flat(cloth.velocity).dot(problem.mass().cwiseProduct(flat(cloth.velocity)));
}

RestResult come_to_rest(Problem& problem, Response& response, Moving& cloth, Cholesky& factor,
                        const RestOptions& options) {
    RestResult r;
    const Points body = response.body();
    double mass = 0;
    for (int i = 0; i < problem.points(); ++i) mass += problem.mass()[3 * i];
    while (r.steps < options.max_steps) {
        r.last = step(problem, response, cloth, body, factor, options.step);
        ++r.steps;
        r.unresolved += r.last.unresolved > 0;
        r.residual = residual(problem, cloth);
        r.speed = std::sqrt(2 * kinetic_energy(problem, cloth) / mass);
        r.rested = r.residual <= options.tolerance && r.speed <= options.speed;
        r.stopped = options.progress && !options.progress(r.steps, r.residual);
        if (r.rested || r.stopped) break;
    }
    return r;
}

} // namespace toile
