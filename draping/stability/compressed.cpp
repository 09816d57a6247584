// SPDX-License-Identifier: GPL-3.0-or-later
// A strip pushed together along its length is about to buckle: the exact second derivative is negative across it.

#include "draping/chart/scene_rest.h"
#include "draping/cloth.h"
#include "draping/solve/implicit.h"
#include "draping/stability/boundary.h"
#include "draping/stability/strip.h"

#include "geometry/text.h"

#include <stdexcept>

namespace toile {

namespace {

constexpr double compression = 0.05;
constexpr double unslowed = 1e3; // m in a step

} // namespace

StabilityScene compressed_scene(Method method) {
    StabilityScene s;
    s.method = method;
    s.name = "compressed, exact second derivative";
    s.what = text("A strip held at both ends is %g %% too short for its cloth. It fails where the matrix of the first step is not positive definite.",
                  100 * compression);
    s.axis = "step";
    s.unit = "s";
    s.measure = "1 where there is a step";
    s.theory = "M + h^2 K becomes indefinite; of two masses at sqrt(m l / 2 k (l0 - l))";
    s.low = 1e-5;
    s.high = 1e-1;
    s.run = [method](const StabilityMesh& mesh, double stiffness, const std::vector<double>& values) {
        SceneCloth cloth = stability_strip(mesh, stiffness);
        hold_far_end(cloth);
        for (Vec3& p : cloth.x) p.x() *= 1 - compression;
        MethodOptions how;
        how.damping_time = 0;
        FreeCloth problem(make_energy(method, cloth.garment, cloth.fabrics, how), node_masses(cloth.garment, cloth.fabrics), false);
        for (const int i : cloth.held) problem.pin(i);
        StabilityColumn column;
        column.boundary = indefinite_step(lowest_eigenvalue(problem, cloth.x));
        const std::unique_ptr<Response> response = no_response(cloth.garment);
        for (const double step : values) {
            ImplicitStepper stepper(problem, *response, {step, 0, unslowed});
            Moving moving{cloth.x};
            moving.velocity.assign(cloth.x.size(), Vec3::Zero());
            try {
                stepper.step(moving, {});
                column.outcomes.push_back({1, ""});
            } catch (const std::runtime_error&) {
                column.outcomes.push_back({0, "not positive definite"});
            }
        }
        return column;
    };
    return s;
}

} // namespace toile
