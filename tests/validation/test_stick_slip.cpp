// SPDX-License-Identifier: GPL-3.0-or-later
// A strip of length L hangs from a clamp that points straight down, nearer to the floor than it is long, so
// that it buckles. Its tip stands on the floor below the clamp and pushes sideways: it sticks while friction
// is at least the ratio of what it pushes sideways to what it pushes down. By the heavy elastica (s = 1 at
// the tip, lengths in L, forces in D / L^2, th from the downward vertical):
//     th'' = -(V - G (1 - s)) sin th - H cos th,  th(0) = 0,  th'(1) = 0,  x(1) = 0,  y(1) = -(1 - eps),
// G = density g L^3 / D. The ratios H / V below are those of its first mode, solved to 1e-9.

#include "draping/cloth.h"
#include "draping/solve/settle.h"

#include "tests/support/plain_fabric.h"
#include "tests/support/plates.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double length = 1, width = 0.15; // m: large against the 0.1 mm of a tie
constexpr double above = 0.49e-3;          // m, about where the tip stands on the barrier

struct Scene {
    double weight; ///< G
    double eps;
    double ratio; ///< H / V
};

Fabric strip(double weight) {
    constexpr double density = 0.15;
    Fabric f = plain_fabric(2e5, weight > 0 ? density * 9.81 * std::pow(length, 3) / weight : 0.15);
    f.shear = 1e5;
    f.compression = 1;
    return f;
}

struct Tip {
    bool settled = false;
    double moved = 0; ///< m, the farthest
};

/// The tip is held sideways while the strip comes to rest on the floor, and then let go.
Tip let_go(const Scene& scene, double friction) {
    const FlatMesh mesh = with_mirror_image(jittered_rectangle(length, width, length / 60, 0.25, 2));
    const Garment garment = garment_of(mesh, EIGEN_PI / 2);
    // First mode or near it, bent so that the tip is where it should be.
    const double clamp = above + (1 - scene.eps) * length, bend = 2 * std::sqrt(scene.eps);
    std::vector<Vec2> curve{Vec2::Zero()};
    const int steps = 1000;
    for (int k = 0; k < steps; ++k) {
        const double angle = bend * std::sin(2 * EIGEN_PI * 0.72 * (k + 0.5) / steps);
        curve.push_back(curve.back() + length / steps * Vec2(std::sin(angle), -std::cos(angle)));
    }
    const Vec2 off = Vec2(0, -(1 - scene.eps) * length) - curve.back();
    Points x;
    std::vector<int> tip;
    for (int i = 0; i < int(mesh.points.size()); ++i) {
        const double s = mesh.points[i].x() / length, z = mesh.points[i].y();
        const Vec2 at = curve[std::lround(steps * std::max(s, 0.0))] + std::max(s, 0.0) * off;
        x.push_back({at.x(), clamp + (s > 0 ? at.y() : -s * length), z});
        if (s > 1 - 1e-9) tip.push_back(i);
    }
    ContactOptions contact;
    contact.body = contact.cloth = {0.5e-3, 0.5e-4, 1e7};
    ClothProblem problem(garment, {strip(scene.weight)}, box(Vec3(-1, -0.1, -1), Vec3(1, 0, 1)), contact);
    problem.gravity = scene.weight > 0 ? 9.81 : 0;
    for (int i = 0; i < int(x.size()); ++i)
        if (mesh.points[i].x() < 1e-9) problem.pin(i);
    for (int i : tip)
        problem.hooks.push_back(
            {i, Vec3(0, 0, x[i].z()), Vec3(1, 0, 1), 1800 * strip(scene.weight).bend_warp, 1e6});
    Cholesky factor;
    SettleOptions options;
    options.tolerance = 1e-4;
    REQUIRE(settle(problem, x, factor, options).end == SettleEnd::settled);
    problem.hooks.clear();
    problem.rest_here(x, {friction}, true);
    const Points start = x;
    options.max_iterations = 100;
    const SettleResult last = settle(problem, x, factor, options);
    Tip t;
    for (int i : tip)
        t.moved = std::max(t.moved, (x[i] - start[i]).norm());
    t.settled = last.end == SettleEnd::settled;
    return t;
}

} // namespace

TEST_CASE("the tip of a buckled strip slips below the friction that the elastica asks for, to 3 %",
          "[validation]") {
    for (const Scene& s : {Scene{0, 0.05, 0.1035447758},
                           {0, 0.3, 0.3264913142},
                           {5, 0.1, 0.1642834147},
                           {10, 0.25, 0.3174241617},
                           {20, 0.2, 0.2950230703}}) {
        INFO("weight " << s.weight << ", eps " << s.eps);
        const Tip sticks = let_go(s, 1.03 * s.ratio);
        CHECK(sticks.settled);
        CHECK(sticks.moved < 5e-4 * length); // single nodes of the row may give way, the row does not
        const Tip slips = let_go(s, 0.97 * s.ratio);
        CHECK(slips.moved > 0.1 * length);
    }
}
