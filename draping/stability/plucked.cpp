// SPDX-License-Identifier: GPL-3.0-or-later
// A clamped strip that cannot stretch is plucked and swings as a cantilever.

#include "draping/chart/scene_rest.h"
#include "draping/solve/stepper.h"
#include "draping/stability/beam.h"
#include "draping/stability/boundary.h"
#include "draping/stability/strip.h"

#include "geometry/text.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace toile {

namespace {

constexpr double amplitude = 1e-3 * strip_length; // m, of the free ends
constexpr double noise = 1e-6 * strip_length;     // m, of everything: what may grow
constexpr int most_steps = 200, most_steps_of_midpoints = 40; // the latter cost ten times as much, and nothing grows in them
constexpr double grown = 2;        // times the energy at the start
constexpr double died = 0.1;       // of the amplitude
constexpr double least_left = 0.5; // of it after a period
constexpr double unslowed = 1e3;   // m in a step

double frequency(const Fabric& f) { return beam_root * beam_root * std::sqrt(f.bend_warp / f.density) / (strip_length * strip_length); }

StabilityOutcome pluck(Method method, const SceneCloth& cloth, double step) {
    const std::unique_ptr<Response> response = no_response(cloth.garment);
    MethodOptions how;
    how.time_step = step;
    const std::unique_ptr<Stepper> stepper =
        make_stepper(method, cloth.garment, cloth.fabrics, held_nodes(cloth), *response, {step, 0, unslowed}, how);
    const double w = frequency(cloth.fabrics[0]);
    std::vector<double> shape;
    for (const Vec3& p : cloth.x) shape.push_back(0.5 * beam_mode(std::abs(p.x()) / strip_length));
    Moving moving{cloth.x};
    for (std::size_t i = 0; i < shape.size(); ++i) moving.x[i].y() += amplitude * shape[i];
    shake(moving.x, noise);
    for (const int i : cloth.held) moving.x[i] = cloth.x[i];
    double whole = 0; // kg that move as the ends do
    for (std::size_t i = 0; i < shape.size(); ++i) whole += stepper->node_mass()[i] * shape[i] * shape[i];
    const double start = 0.5 * whole * w * w * amplitude * amplitude; // J
    double share = 1, first = 1; // of the amplitude; after the first step, which is one of implicit Euler whatever follows
    int steps = 0;
    while (steps < 2 || (steps < (method == Method::nonconforming ? most_steps_of_midpoints : most_steps) && share > died * first)) {
        try {
            stepper->step(moving, {});
        } catch (const std::runtime_error&) {
            return {INFINITY, "blew up"};
        }
        ++steps;
        const double moves = kinetic_energy(stepper->node_mass(), moving) / start;
        if (!(moves < grown)) return {moves, "blew up"};
        double place = 0, speed = 0;
        for (std::size_t i = 0; i < shape.size(); ++i) {
            place += stepper->node_mass()[i] * shape[i] * (moving.x[i] - cloth.x[i]).y() / whole;
            speed += stepper->node_mass()[i] * shape[i] * moving.velocity[i].y() / whole;
        }
        share = std::hypot(place, speed / w) / amplitude;
        if (steps == 1) first = share;
    }
    const double left = std::pow(share / first, std::max(1.0, 2 * std::numbers::pi / (w * step)) / (steps - 1));
    return {left, left < least_left ? "damped away" : ""};
}

} // namespace

StabilityScene plucked_scene(Method method) {
    StabilityScene s;
    s.method = method;
    s.name = "plucked";
    s.what = text("A strip clamped at one end swings as a cantilever. It fails where it moves with more than twice the energy of the start, or less than %g %% of the amplitude is left after a period.",
                  100 * least_left);
    s.axis = "step";
    s.unit = "s";
    s.measure = "amplitude left after a period";
    const bool second_order = method == Method::nonconforming;
    s.theory = text("%s leaves half of the amplitude", second_order ? "BDF2" : "implicit Euler");
    s.low = 1e-3;
    s.high = 1;
    s.stiffness_matters = !second_order; // which has no stretch
    s.run = [method, second_order](const StabilityMesh& mesh, double stiffness, const std::vector<double>& values) {
        const SceneCloth cloth = stability_arms(mesh, stiffness);
        StabilityColumn column;
        column.boundary = (second_order ? bdf2_swing_step : swing_step)(frequency(cloth.fabrics[0]), least_left);
        for (const double step : values) column.outcomes.push_back(pluck(method, cloth, step));
        return column;
    };
    return s;
}

} // namespace toile
