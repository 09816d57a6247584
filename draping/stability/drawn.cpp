// SPDX-License-Identifier: GPL-3.0-or-later
// A strip drawn out by its ends and plucked: local and global steps bring it back to the plane by a share of about its strain each.

#include "draping/chart/scene_rest.h"
#include "draping/cloth.h"
#include "draping/energy/projective.h"
#include "draping/solve/free_cloth.h"
#include "draping/solve/projective.h"
#include "draping/stability/boundary.h"
#include "draping/stability/strip.h"

#include <cmath>
#include <numbers>

namespace toile {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double tension = 10;               // times the plate's stiffness over the length squared, N/m
constexpr double pluck = 1e-5 * strip_length; // m: no stretch to speak of
constexpr double left = 0.1;                 // of it
constexpr double no_time = 1e6;              // s, of a step whose inertia counts for nothing
constexpr double unslowed = 1e3;             // m in a step

} // namespace

StabilityScene drawn_scene() {
    StabilityScene s;
    s.method = Method::projective;
    s.name = "plucked";
    s.what = "A strip is drawn out by 10 D / L^2 and plucked by its slowest motion. It fails where more than 10 % of the pluck is left.";
    s.axis = "iterations";
    s.measure = "share of the pluck that is left";
    s.theory = "1 - strain per iteration";
    s.low = 1;
    s.high = 1e4;
    s.whole = true;
    s.fails_above = false;
    s.run = [](const StabilityMesh& mesh, double stiffness, const std::vector<double>& values) {
        SceneCloth cloth = stability_strip(mesh, stiffness);
        hold_far_end(cloth);
        cloth.fabrics[0].shear = 0; // lines along warp and weft alone, as the rate is derived for
        const double strain = tension / stiffness;
        StabilityColumn column;
        column.boundary = times_until(projective_rate(strain, pi * pi / stiffness), left);
        auto model = std::make_unique<ProjectiveCloth>(cloth.garment, cloth.fabrics);
        const ProjectiveCloth& energy = *model;
        auto problem = std::make_unique<FreeCloth>(std::move(model), node_masses(cloth.garment, cloth.fabrics));
        for (const int i : cloth.held) problem->pin(i);
        const std::unique_ptr<Response> response = no_response(cloth.garment);
        ProjectiveStepper stepper(std::move(problem), energy, *response, {no_time, 0, unslowed}, 1);
        Moving moving{cloth.x};
        for (Vec3& p : moving.x) p = Vec3((1 + strain) * p.x(), pluck * std::sin(pi * p.x() / strip_length), p.z());
        int done = 0;
        for (const double iterations : values) {
            for (; done < int(iterations); ++done) stepper.step(moving, {});
            double most = 0;
            for (const Vec3& p : moving.x) most = std::max(most, std::abs(p.y()));
            column.outcomes.push_back({most / pluck, most > left * pluck ? "too slow" : ""});
        }
        return column;
    };
    return s;
}

} // namespace toile
