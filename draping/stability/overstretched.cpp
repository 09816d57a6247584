// SPDX-License-Identifier: GPL-3.0-or-later
// A strip of which every spring along it is longer than its limit: one spring after the other is shortened, and lengthens its neighbours.

#include "draping/chart/scene_rest.h"
#include "draping/cloth.h"
#include "draping/energy/spring_mesh.h"
#include "draping/solve/free_cloth.h"
#include "draping/solve/limited.h"
#include "draping/stability/boundary.h"
#include "draping/stability/strip.h"

#include <cmath>

namespace toile {

namespace {

constexpr double limit = 0.05, beyond = 0.05; // of a length
constexpr double left = 0.1;                  // of what they are too long by
constexpr double no_time = 1e-9;              // s, in which nothing else moves
constexpr double unslowed = 1e9;              // m in a step

/// What the springs along the strip are too long by at most, as a share of what they were.
double excess(const SceneCloth& cloth, const std::vector<Spring>& springs, const Points& start, const LimitOptions& how) {
    auto problem = std::make_unique<FreeCloth>(std::make_unique<Springs>(springs), node_masses(cloth.garment, cloth.fabrics));
    for (const int i : cloth.held) problem->pin(i);
    const std::unique_ptr<Response> response = no_response(cloth.garment);
    LimitedStepper stepper(std::move(problem), springs, *response, {no_time, 0, unslowed}, how);
    stepper.substep = no_time;
    Moving moving{start};
    stepper.step(moving, {});
    double most = 0;
    for (const Spring& s : springs)
        if (s.kind == SpringKind::warp) most = std::max(most, (moving.x[s.b] - moving.x[s.a]).norm() / s.length - 1 - s.limit);
    return most / beyond;
}

} // namespace

StabilityScene overstretched_scene(ChainOrder order) {
    const bool hangs = order == ChainOrder::from_held_end;
    StabilityScene s;
    s.method = Method::springs_limited;
    s.name = std::string("overstretched, swept from the ") + (hangs ? "held" : "free") + " end";
    s.what = std::string("A strip that ") + (hangs ? "hangs" : "stands") + " by one end, swept from its top down, is stretched to 10 %, with limits of 5 %. It fails where a spring along it is left with more than 10 % of what it was too long by.";
    s.axis = "sweeps";
    s.measure = "share of the excess that is left";
    s.theory = "a chain of equal links, swept alike";
    s.low = 1;
    s.high = 1e3;
    s.whole = true;
    s.fails_above = false;
    s.run = [order, hangs](const StabilityMesh& mesh, double stiffness, const std::vector<double>& values) {
        SceneCloth cloth = stability_strip(mesh, stiffness);
        cloth.fabrics[0].limit_warp = cloth.fabrics[0].limit_weft = cloth.fabrics[0].limit_shear = limit;
        const std::vector<Spring> springs = mesh_springs(cloth.garment, cloth.fabrics);
        Points start = cloth.x;
        for (Vec3& p : start) p = Vec3(0, (hangs ? -1 : 1) * (1 + limit + beyond) * p.x(), p.z());
        StabilityColumn column;
        column.boundary = limit_sweeps(strip_rows, order, left, strip_end_mass);
        for (const double sweeps : values) {
            const double now = excess(cloth, springs, start, {false, SweepOrder::from_top, int(sweeps)});
            column.outcomes.push_back({now, now > left ? "too long" : ""});
        }
        return column;
    };
    return s;
}

} // namespace toile
