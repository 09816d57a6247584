// SPDX-License-Identifier: GPL-3.0-or-later
// A strip swings along its length. Explicit steps that are too long make something grow, implicit ones take the swing away.

#include "draping/chart/scene_rest.h"
#include "draping/cloth.h"
#include "draping/solve/stability.h"
#include "draping/solve/stepper.h"
#include "draping/stability/boundary.h"
#include "draping/stability/strip.h"

#include "geometry/text.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace toile {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double amplitude = 1e-3 * strip_length; // m, of the free end
constexpr double noise = 1e-7 * strip_length;     // m, of everything: what may grow
constexpr int most_steps = 300;
constexpr double grown = 2;      // times the energy at the start
constexpr double died = 1e-2;    // of it; less may be that of slower motions, which stay
constexpr double least_left = 0.5; // of the amplitude after a period
constexpr double unslowed = 1e3; // m in a step

bool is_explicit(Method m) { return m == Method::springs_explicit || m == Method::springs_limited; }

/// rad/s, of a quarter of a wave between the held end and the free one.
double frequency(const Fabric& f) { return pi / (2 * strip_length) * std::sqrt(f.stretch_warp / f.density); }

StabilityOutcome swing(Method method, const SceneCloth& cloth, FreeCloth& energy, double step) {
    const std::unique_ptr<Response> response = no_response(cloth.garment);
    MethodOptions how;
    how.damping_time = 0;
    how.time_step = step;
    const std::unique_ptr<Stepper> stepper =
        make_stepper(method, cloth.garment, cloth.fabrics, held_nodes(cloth), *response, {step, 0, unslowed}, how);
    Moving moving{cloth.x};
    for (std::size_t i = 0; i < cloth.x.size(); ++i) moving.x[i].x() += amplitude * std::sin(0.5 * pi * cloth.x[i].x() / strip_length);
    shake(moving.x, noise);
    for (const int i : cloth.held) moving.x[i] = cloth.x[i];
    const double start = energy.value(moving.x);
    double share = 1;
    int steps = 0;
    while (steps < most_steps && share > died) {
        try {
            stepper->step(moving, {});
        } catch (const std::runtime_error&) {
            return {INFINITY, "blew up"};
        }
        ++steps;
        share = (energy.value(moving.x) + kinetic_energy(stepper->node_mass(), moving)) / start;
        if (!(share < grown)) return {std::isfinite(share) ? std::sqrt(share) : INFINITY, "blew up"};
    }
    // Motion and stretch share the energy of a swing, so that its loss tells of the amplitude at any time.
    const double steps_a_period = std::max(1.0, 2 * pi / (frequency(cloth.fabrics[0]) * step));
    const double left = std::pow(share, 0.5 * steps_a_period / steps);
    return {left, left < least_left ? "damped away" : ""};
}

} // namespace

StabilityScene swing_scene(Method method) {
    StabilityScene s;
    s.method = method;
    s.name = "swing";
    s.what = text("A strip swings along its length. It fails where its energy grows to more than twice, or less than %g %% of the amplitude is left after a period.",
                  100 * least_left);
    s.axis = "step";
    s.unit = "s";
    s.measure = "amplitude left after a period";
    s.theory = is_explicit(method) ? "2 / w of the fastest motion" : "implicit Euler leaves half of the amplitude";
    s.low = 1e-5;
    s.high = 1e-1;
    s.run = [method](const StabilityMesh& mesh, double stiffness, const std::vector<double>& values) {
        const SceneCloth cloth = stability_strip(mesh, stiffness);
        MethodOptions undamped;
        undamped.damping_time = 0;
        FreeCloth energy(make_energy(newton_twin(method), cloth.garment, cloth.fabrics, undamped), node_masses(cloth.garment, cloth.fabrics), false);
        for (const int i : cloth.held) energy.pin(i);
        StabilityColumn column;
        if (lowest_eigenvalue(energy, cloth.x) < 0) { // springs that bend push: where they pull too little beside, flat cloth is no rest
            column.outcomes.assign(values.size(), {0, "flat cloth is no rest"});
            return column;
        }
        column.boundary = is_explicit(method) ? fastest(energy, cloth.x).step() : swing_step(frequency(cloth.fabrics[0]), least_left);
        for (const double step : values) column.outcomes.push_back(swing(method, cloth, energy, step));
        return column;
    };
    return s;
}

} // namespace toile
