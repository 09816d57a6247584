// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Flat sheets on bodies, without patterns and seams: what contact alone has to bear.

#include "draping/cloth.h"
#include "draping/solve/settle.h"
#include "tests/support/flat_mesh.h"

#include <algorithm>
#include <limits>
#include <memory>

namespace toile::test {

/// Adds a copy of a mesh; its points are moved apart in the plane, which contact in space does not see.
inline void add_sheet(FlatMesh& all, const FlatMesh& sheet, double aside) {
    const int first = int(all.points.size());
    for (const Vec2& p : sheet.points) all.points.push_back(p + Vec2(aside, 0));
    for (const Triangle& t : sheet.triangles) all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

/// One cloth, one body, and the solver that brings them to rest.
struct ClothScene {
    Garment garment;
    TriMesh body;
    Points x;
    std::unique_ptr<ClothProblem> problem;
    Cholesky factor;

    ClothScene(Garment g, TriMesh on, Points start, const Fabric& fabric, const FrictionCoefficients& friction)
        : garment(std::move(g)), body(std::move(on)), x(std::move(start)),
          problem(std::make_unique<ClothProblem>(garment, PanelFabrics{fabric}, body, barriers_at(0.5e-3, fabric.density))) {
        problem->gravity = 9.81;
        problem->rest_here(x, friction);
    }

    bool settle_to(double tolerance, int most) {
        SettleOptions o;
        o.tolerance = tolerance;
        o.max_iterations = most;
        o.max_step = 0.01;
        o.exact_below = tolerance < 1 ? 20 : 0;
        return settle(*problem, x, factor, o).end == SettleEnd::settled;
    }

    /// By exact predicates.
    int crossings() const {
        const IntersectionCount n = count_intersections(node_triangles(garment), x, body, garment.stitches);
        return n.cloth_avatar + n.cloth_cloth;
    }

    double lowest() const {
        double y = std::numeric_limits<double>::infinity();
        for (const Vec3& p : x) y = std::min(y, p.y());
        return y;
    }
    double highest() const {
        double y = -std::numeric_limits<double>::infinity();
        for (const Vec3& p : x) y = std::max(y, p.y());
        return y;
    }
};

} // namespace toile::test
