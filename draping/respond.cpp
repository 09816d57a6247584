// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/respond.h"

#include "draping/solve/barrier_response.h"
#include "draping/solve/implicit.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

constexpr double time_step = 2e-3;      // s
constexpr double barrier_step = 5e-4;   // s: forces that are held from step to step follow stiff cloth the sooner
constexpr double damping = 10;          // 1/s: falls at 1 m/s, swings die away in half a second
constexpr double most_motion = 5e-3;    // m in a step
constexpr double rest_speed = 1e-3;     // m/s
constexpr double passing_speed = 2e-2;  // m/s, of passes that are not the last
constexpr double repulsion = 1e3;       // N/m, of springs that act by a tenth of what is missing in a step anyway
constexpr double penalty_share = 0.25;  // of m / dt2: a stiffer spring, with its dampers, does not bear such steps
constexpr double damper_share = 0.05;   // of m / dt
constexpr double depth = 10e-3;         // m: lists of pairs grow long with it
constexpr int steps_per_iteration = 8;  // a motion takes more steps than Newton's method
constexpr ContactOptions no_contact{{1, 0, 0}, {1, 0, 0}, false};

ResponseOptions response_options(const DrapeRun& run, const ClothProblem& problem, double step) {
    ResponseOptions o;
    o.thickness = run.contact_options().body.distance;
    o.body_friction = run.result.friction.body;
    o.cloth_friction = run.result.friction.cloth;
    o.stiffness = repulsion;
    if (response_of(run.options) != ContactResponse::penalty) return o;
    double mass = 0;
    for (const double m : problem.node_mass()) mass += m / problem.points();
    o.stiffness = penalty_share * mass / (step * step);
    o.depth = depth;
    o.normal_damping = o.tangential_damping = damper_share * mass / step;
    return o;
}

} // namespace

LevelInMotion::LevelInMotion(const DrapeRun& run, const ClothProblem& at_rest) {
    const MethodOptions& how = run.options.method_options;
    const bool barrier = response_of(run.options) == ContactResponse::barrier;
    StepOptions step{barrier ? barrier_step : time_step, damping, std::min(most_motion, run.edge_length())};
    if (how.time_step > 0 && run.options.method == Method::equilibrium) step.time_step = how.time_step;
    const ResponseOptions answer = response_options(run, at_rest, std::max(step.time_step, how.time_step));
    if (barrier)
        response = barrier_response(contact_cloth(run.garment), run.body, run.contact_options(), answer);
    else
        response = make_response(response_of(run.options), contact_cloth(run.garment), run.body, answer);
    if (run.options.method != Method::equilibrium) {
        stepper = make_stepper(run.options.method, run.garment, run.level_fabrics(), at_rest.pinned(), *response, step, how);
    } else {
        sheet = std::make_unique<ClothProblem>(run.garment, run.level_fabrics(), TriMesh{}, no_contact);
        for (int i = 0; i < sheet->points(); ++i)
            if (at_rest.pinned()[i]) sheet->pin(i);
        stepper = std::make_unique<ImplicitStepper>(*sheet, *response, step);
    }
    stepper->loads() = at_rest;
    cloth.x = run.x;
}

RestResult LevelInMotion::rest(DrapeRun& run, double tolerance, int iterations, bool last) {
    RestOptions o;
    o.tolerance = tolerance;
    o.speed = last ? rest_speed : passing_speed;
    o.max_steps = steps_per_iteration * std::min(iterations, run.iterations_left);
    const double from = run.share_begin, span = run.share_end - run.share_begin;
    o.progress = [&, base = run.done](int i, double r) {
        const double within = (base - from) / std::max(span, 1e-9);
        return run.tell(within + (1 - within) * (1 - std::exp(-i / 500.0)), r);
    };
    const RestResult r = come_to_rest(*stepper, cloth, response->body(), o);
    run.x = cloth.x;
    run.result.residual = r.residual;
    run.iterations_left -= (r.steps + steps_per_iteration - 1) / steps_per_iteration;
    run.result.levels.back().iterations += r.steps;
    run.result.levels.back().factorisations += r.factorisations;
    run.result.contact.unresolved += r.unresolved;
    return r;
}

TouchFacts LevelInMotion::touch_facts(const Contact& near) const {
    TouchFacts facts;
    for (const ActivePair& a : near.active(cloth.x)) ++(near.pair(a.pair).with_body ? facts.body_pairs : facts.cloth_pairs);
    for (const Vec3& force : cloth.contact_force()) {
        facts.touching_nodes += force.squaredNorm() > 0;
        facts.press += force.norm();
    }
    return facts;
}

} // namespace toile
