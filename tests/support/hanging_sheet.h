// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A square sheet that hangs by two corners: what a mesh that locks gets wrong.

#include "draping/cloth.h"
#include "draping/solve/settle.h"
#include "tests/support/flat_mesh.h"

#include <cmath>

namespace toile::test {

struct HungSheet {
    Points x;
    bool settled = false;
    double drop = 0; ///< m, of the lowest node below the corners
    double sag = 0;  ///< m, of the lowest node of the upper border below the corners
    int iterations = 0;
};

/// 0.5 m, held at two corners 0.4 m apart; settled for each membrane stiffness (N/m) in turn, from the state
/// before. At so small an angle between its halves the sheet folds deeply from the corners and is curved
/// everywhere.
inline std::vector<HungSheet> hang_sheet(double edge, std::uint64_t seed,
                                         const std::vector<double>& stiffness) {
    const double side = 0.5, apart = 0.8;
    const FlatMesh mesh = jittered_rectangle(side, side, edge, 0.25, seed);
    const Garment garment = garment_of(mesh);
    // A sheet folded down its middle, and rough.
    Random random(seed);
    Points x;
    for (const Vec2& p : mesh.points) {
        const double across = p.x() - side / 2;
        x.push_back(
            Vec3(apart * across, p.y() - side, std::sqrt(1 - apart * apart) * (side / 2 - std::abs(across))) +
            random.vec3(1e-4));
    }
    for (int i = 0; i < garment.node_count; ++i)
        if (mesh.points[i].y() == side && std::abs(mesh.points[i].x() - side / 2) == side / 2)
            x[i] = {apart * (mesh.points[i].x() - side / 2), 0, 0};
    std::vector<HungSheet> hung;
    for (double k : stiffness) {
        Fabric fabric;
        fabric.name = "sheet";
        fabric.density = 0.15;
        fabric.stretch_warp = fabric.stretch_weft = k;
        fabric.shear = k / 2;
        fabric.bend_warp = fabric.bend_weft = 1e-5;
        fabric.bend_twist = 0.5e-5;
        const Barrier unused{0.5e-3, 0.5e-4, 1e6};
        ClothProblem problem(garment, {fabric}, {}, {unused, unused, false});
        problem.gravity = 9.81;
        for (int i = 0; i < garment.node_count; ++i)
            if (mesh.points[i].y() == side && std::abs(mesh.points[i].x() - side / 2) == side / 2)
                problem.pin(i);
        SettleOptions options;
        options.tolerance = 1e-4;
        options.max_iterations = 1500;
        Cholesky factor;
        const SettleResult r = settle(problem, x, factor, options);
        HungSheet h;
        h.x = x;
        h.settled = r.end == SettleEnd::settled;
        h.iterations = r.iterations;
        for (int i = 0; i < garment.node_count; ++i) {
            h.drop = std::max(h.drop, -x[i].y());
            if (mesh.points[i].y() == side) h.sag = std::max(h.sag, -x[i].y());
        }
        hung.push_back(h);
    }
    return hung;
}

/// Farthest that any node lies from where it is in the other.
inline double farthest(const HungSheet& a, const HungSheet& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.x.size(); ++i)
        most = std::max(most, (a.x[i] - b.x[i]).norm());
    return most;
}

} // namespace toile::test
