// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A unit square of cloth that is pulled along x, its sides free.

#include "tests/support/flat_mesh.h"
#include "tests/support/static_solver.h"

#include <catch2/catch.hpp>

namespace toile::test {

inline FlatMesh unit_square() { return jittered_rectangle(1, 1, 0.2, 0.25, 3); }

/// Mean strain (along, across) under `stress` (N/m) on the sides x = 0 and x = 1 of cloth that resists by `model`, over the
/// nodes of unit_square().
inline Vec2 pulled_strain(const Term& model, double stress) {
    const FlatMesh mesh = unit_square();
    const int n = int(mesh.points.size());
    Points flat_places = flat_points(mesh);
    const Eigen::VectorXd q = flat(flat_places);
    Eigen::VectorXd load = Eigen::VectorXd::Zero(3 * n);
    for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) { // traction on border edges
            const int a = t[k], b = t[(k + 1) % 3];
            const Vec2 &p = mesh.points[a], &r = mesh.points[b];
            for (double side : {0.0, 1.0})
                if (std::abs(p.x() - side) < 1e-9 && std::abs(r.x() - side) < 1e-9)
                    for (int end : {a, b}) load[3 * end] += (2 * side - 1) * stress * (p - r).norm() / 2;
        }
    Freedoms freedoms(q);
    // Rigid motions: one corner stays, another keeps its height.
    int origin = 0, right = 0, top = 0;
    for (int i = 0; i < n; ++i) {
        freedoms.hold(3 * i + 2, 0);
        if (mesh.points[i].norm() < 1e-9) origin = i;
        if ((mesh.points[i] - Vec2(1, 0)).norm() < 1e-9) right = i;
        if ((mesh.points[i] - Vec2(0, 1)).norm() < 1e-9) top = i;
    }
    freedoms.hold(3 * origin, 0);
    freedoms.hold(3 * origin + 1, 0);
    freedoms.hold(3 * right + 1, 0);
    freedoms.number();
    const StaticResult r = solve_static({model}, load, freedoms, q);
    REQUIRE(r.converged);
    return {r.q[3 * right] - 1, r.q[3 * top + 1] - 1};
}

} // namespace toile::test
