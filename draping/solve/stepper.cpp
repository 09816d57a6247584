// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/stepper.h"

#include <cmath>
#include <numeric>
#include <stdexcept>

namespace toile {

Points Moving::contact_force() const {
    Points force = other_force;
    force.resize(x.size(), Vec3::Zero());
    for (const HeldTouch& h : touches)
        for (int k = 0; k < 4; ++k)
            if (h.touch.point[k] < int(x.size())) force[h.touch.point[k]] += h.touch.weight[k] * h.touch.force;
    return force;
}

Points body_velocities(const Response& response, const Points& body_end, double dt) {
    Points velocity(body_end.size());
    for (std::size_t i = 0; i < body_end.size(); ++i) velocity[i] = (body_end[i] - response.body()[i]) / dt;
    return velocity;
}

Vec3 rate(const Touch& t, const Points& v, const Points& body_velocity) {
    Vec3 sum = Vec3::Zero();
    const int n = int(v.size());
    for (int k = 0; k < 4; ++k)
        if (t.weight[k] != 0) sum += t.weight[k] * (t.point[k] < n ? v[t.point[k]] : body_velocity[t.point[k] - n]);
    return sum;
}

double kinetic_energy(const std::vector<double>& node_mass, const Moving& cloth) {
    double sum = 0;
    for (std::size_t i = 0; i < cloth.velocity.size(); ++i) sum += 0.5 * node_mass[i] * cloth.velocity[i].squaredNorm();
    return sum;
}

void slow(Points& v, double dt, double max_motion) {
    for (Vec3& u : v) {
        const double far = dt * u.norm();
        if (!std::isfinite(far)) throw std::runtime_error("the motion of the cloth is no longer finite");
        if (far > max_motion) u *= max_motion / far;
    }
}

ResponseDone respond(Moving& cloth, Response& response, const ResponseStep& step, Points& v) {
    const Stopwatch::Lap lap(cloth.contact);
    return response.respond(step, v);
}

ResponseDone go(Moving& cloth, Response& response, const std::vector<double>& inverse_mass, const Points& body_end,
                const StepOptions& options, Points v, Points end) {
    const double dt = options.time_step;
    cloth.velocity.resize(cloth.x.size(), Vec3::Zero());
    if (response.lasts() && !cloth.other_force.empty())
        for (std::size_t i = 0; i < v.size(); ++i) {
            const Vec3 held = dt * inverse_mass[i] * cloth.other_force[i];
            v[i] -= held;
            end[i] -= held;
        }
    slow(v, dt, options.max_motion);
    slow(end, dt, options.max_motion);
    const Points without = v;
    ResponseDone done = respond(cloth, response, {dt, cloth.x, cloth.velocity, inverse_mass, body_end}, v);
    cloth.touches.clear();
    for (const Touch& t : done.touches) cloth.touches.push_back({t});
    cloth.other_force = done.other_force;
    for (std::size_t i = 0; i < cloth.x.size(); ++i) {
        cloth.x[i] += dt * v[i];
        end[i] += v[i] - without[i];
    }
    cloth.velocity = std::move(end);
    return done;
}

RestResult come_to_rest(Stepper& stepper, Moving& cloth, const Points& body, const RestOptions& options) {
    RestResult r;
    const int factorised = stepper.factorisations();
    const std::vector<double>& mass = stepper.node_mass();
    const double all = std::accumulate(mass.begin(), mass.end(), 0.0);
    while (r.steps < options.max_steps) {
        const Points before = cloth.x;
        ResponseDone done;
        try {
            done = stepper.step(cloth, body);
        } catch (const std::runtime_error& error) {
            r.broken = error.what();
            break;
        }
        ++r.steps;
        r.unresolved += done.unresolved > 0;
        r.residual = stepper.residual(cloth);
        double sum = 0;
        for (std::size_t i = 0; i < mass.size(); ++i) sum += mass[i] * (cloth.x[i] - before[i]).squaredNorm();
        r.speed = std::sqrt(sum / all) / stepper.options().time_step;
        r.rested = r.residual <= options.tolerance && r.speed <= options.speed;
        r.stopped = options.progress && !options.progress(r.steps, r.residual);
        if (r.rested || r.stopped) break;
    }
    r.factorisations = stepper.factorisations() - factorised;
    return r;
}

} // namespace toile
