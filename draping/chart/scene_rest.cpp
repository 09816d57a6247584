// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/chart/scene_rest.h"

#include "draping/settle_cloth.h"
#include "draping/solve/barrier_response.h"
#include "draping/solve/stepper.h"

#include <ctime>
#include <memory>

namespace toile {

namespace {

constexpr double damping = 10;        // 1/s, of air: falls at 1 m/s, swings die away in half a second
constexpr double time_step = 2e-3;    // s
constexpr double most_motion = 5e-3;  // m in a step
constexpr double rest_speed = 1e-3;   // m/s
constexpr int most_steps = 200000;
constexpr double barrier_step = 5e-4; // s, as in a drape on a body: forces that are held from step to step follow stiff cloth the sooner
constexpr double clearance = 0.5e-3;  // m

/// By the processor time of all threads, so that a busy machine does not change what is out of time.
class Deadline {
public:
    explicit Deadline(double seconds) : end_(processor_seconds() + seconds) {}
    bool passed() const { return processor_seconds() > end_; }

private:
    double end_;
};

std::unique_ptr<Response> on_body(const SceneCloth& cloth) {
    ResponseOptions answer;
    answer.thickness = clearance;
    answer.body_friction = cloth.friction;
    answer.self = false;
    return barrier_response(contact_cloth(cloth.garment), cloth.body, scene_contact(cloth), answer);
}

void fail_late(SceneRest& rest) {
    rest.failure = "out of time";
    rest.out_of_time = true;
}

SceneRest by_newton(const SceneCloth& cloth, const SceneRestOptions& options, const Deadline& deadline) {
    ClothProblem problem(make_energy(options.method, cloth.garment, cloth.fabrics, {}), cloth.garment, cloth.fabrics, cloth.body,
                         scene_contact(cloth));
    static_cast<Loads&>(problem) = cloth.loads;
    if (cloth.friction > 0) problem.rest_here(cloth.x, {cloth.friction, 0}, true);
    for (const int i : cloth.held) problem.pin(i);
    SettleOptions o;
    o.tolerance = options.tolerance;
    o.max_iterations = options.max_iterations;
    o.progress = [&](int, double) { return !deadline.passed(); };
    Cholesky factor;
    SceneRest rest;
    rest.x = cloth.x;
    const SettleResult r = settle_constrained(problem, rest.x, o, [&](const SettleOptions& some) { return settle_cloth(problem, rest.x, factor, some); });
    rest.residual = r.residual;
    switch (r.end) {
    case SettleEnd::settled: break;
    case SettleEnd::iterations: rest.failure = "out of iterations"; break;
    case SettleEnd::stalled: rest.failure = "stalled"; break;
    case SettleEnd::stopped: fail_late(rest); break;
    }
    return rest;
}

SceneRest by_motion(const SceneCloth& cloth, const SceneRestOptions& options, const Deadline& deadline) {
    const bool touches = !cloth.body.triangles.empty();
    const std::unique_ptr<Response> response = touches ? on_body(cloth) : no_response(cloth.garment);
    std::vector<char> held(cloth.x.size(), 0);
    for (const int i : cloth.held) held[i] = 1;
    MethodOptions how;
    how.time_step = options.time_step;
    const std::unique_ptr<Stepper> stepper = make_stepper(options.method, cloth.garment, cloth.fabrics, held, *response,
                                                          {touches ? barrier_step : time_step, damping, most_motion}, how);
    stepper->loads() = cloth.loads;
    Moving moving{cloth.x};
    RestOptions o;
    o.tolerance = options.tolerance;
    o.speed = rest_speed;
    o.max_steps = most_steps;
    o.progress = [&](int, double) { return !deadline.passed(); };
    const RestResult r = come_to_rest(*stepper, moving, cloth.body.points, o);
    SceneRest rest{moving.x, r.residual, r.broken, false};
    if (r.stopped)
        fail_late(rest);
    else if (rest.failure.empty() && !r.rested)
        rest.failure = "out of steps";
    return rest;
}

} // namespace

SceneRest rest_of(const SceneCloth& cloth, const SceneRestOptions& options) {
    if (cloth.rest) return cloth.rest(cloth.x, options);
    const Deadline deadline(options.max_seconds);
    return settles(options.method) ? by_newton(cloth, options, deadline) : by_motion(cloth, options, deadline);
}

ContactOptions scene_contact(const SceneCloth& cloth) {
    ContactOptions contact = barriers_at(clearance, cloth.fabrics[0].density);
    contact.self = false;
    return contact;
}

double processor_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

std::unique_ptr<Response> no_response(const Garment& garment) {
    ResponseOptions alone;
    alone.self = false;
    return make_response(ContactResponse::impulse, contact_cloth(garment), {}, alone);
}

Method newton_twin(Method method) {
    switch (method) {
    case Method::springs_explicit:
    case Method::springs_limited: return Method::springs_implicit; // no scene comes near a limit
    case Method::xpbd: return Method::triangles;
    default: return method;
    }
}

} // namespace toile
