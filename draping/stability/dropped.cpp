// SPDX-License-Identifier: GPL-3.0-or-later
// A strip that hangs is let go: in a sweep, position by position, each row is told of its neighbours alone.

#include "draping/chart/scene_rest.h"
#include "draping/cloth.h"
#include "draping/energy/triangles.h"
#include "draping/solve/free_cloth.h"
#include "draping/solve/xpbd.h"
#include "draping/stability/boundary.h"
#include "draping/stability/strip.h"

#include <cmath>
#include <numbers>

namespace toile {

namespace {

constexpr double step = 0.02;   // s
constexpr double weight = 1e-4; // m/s2: so little that no cloth is stretched by more than 0.01 %
constexpr double left = 0.1;    // of the free fall
constexpr int all_sweeps = 4000; // leave nothing of it
constexpr double unslowed = 1e3; // m in a step

/// Where the free end is after one step of so many sweeps, m.
double fallen(const SceneCloth& cloth, int sweeps) {
    auto model = std::make_unique<TriangleCloth>(cloth.garment, cloth.fabrics);
    const TriangleCloth& energy = *model;
    auto problem = std::make_unique<FreeCloth>(std::move(model), node_masses(cloth.garment, cloth.fabrics));
    for (const int i : cloth.held) problem->pin(i);
    const std::unique_ptr<Response> response = no_response(cloth.garment);
    XpbdStepper stepper(std::move(problem), energy, *response, {step, 0, unslowed}, {1, sweeps});
    stepper.loads().gravity = weight;
    Moving moving{cloth.x};
    stepper.step(moving, {});
    double most = 0;
    for (std::size_t i = 0; i < cloth.x.size(); ++i) most = std::max(most, cloth.x[i].y() - moving.x[i].y());
    return most;
}

} // namespace

StabilityScene dropped_scene() {
    StabilityScene s;
    s.method = Method::xpbd;
    s.name = "let go";
    s.what = "A strip that hangs by one end is let go for one step of 20 ms. It fails where its end is off implicit Euler by more than 10 % of the free fall.";
    s.axis = "sweeps";
    s.measure = "share of the free fall that it is off";
    s.theory = "N^2 / sweeps";
    s.low = 1;
    s.high = 1e3;
    s.whole = true;
    s.fails_above = false;
    s.run = [](const StabilityMesh& mesh, double stiffness, const std::vector<double>& values) {
        SceneCloth cloth = stability_strip(mesh, stiffness);
        for (Vec3& p : cloth.x) p = Vec3(0, -p.x(), p.z());
        Fabric& f = cloth.fabrics[0];
        f.stretch_weft = f.shear = 1e-6 * f.stretch_warp; // which would take word across, and on from there
        const double link = strip_length / strip_rows;
        StabilityColumn column;
        const double softness = f.stretch_warp * step * step / (f.density * link * link);
        // The slowest motion of a chain that all falls alike has 4 / pi of the fall at its end, of which implicit Euler takes off what its stiffness says.
        const double slowest = softness * std::pow(std::numbers::pi / (2 * strip_rows), 2);
        const double error = 4 / std::numbers::pi * slowest / (1 + slowest);
        column.boundary = std::max(0.0, times_until(sweep_rate(strip_rows, softness, strip_end_mass), left / error));
        const double exact = fallen(cloth, all_sweeps), fall = weight * step * step;
        for (const double sweeps : values) {
            const double off = std::abs(fallen(cloth, int(sweeps)) - exact) / fall;
            column.outcomes.push_back({off, off > left ? "too soft" : ""});
        }
        return column;
    };
    return s;
}

} // namespace toile
