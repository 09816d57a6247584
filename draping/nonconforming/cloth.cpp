// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/nonconforming/cloth.h"

namespace toile {

NonconformingCloth make_nonconforming_cloth(const Garment& garment, const std::vector<Fabric>& fabrics,
                                            const std::vector<Clamp>& clamps) {
    return {make_midpoints(garment, fabrics), make_midpoint_bending(garment, fabrics, clamps),
            triangle_bars(garment)};
}

IsometricProblem problem_of(const NonconformingCloth& cloth, const Vec3& gravity, const Points& ghost_forces,
                            const std::vector<GhostSpring>& springs) {
    IsometricProblem problem;
    problem.stiffness = cloth.bending.stiffness;
    problem.bars = cloth.bars;
    problem.held.assign(cloth.midpoints.count(), 0);
    problem.load = from_ghost_nodes(cloth.midpoints, ghost_forces);
    const Eigen::Matrix<double, Eigen::Dynamic, 3> clamps =
        cloth.bending.rows.transpose() * cloth.bending.offset;
    for (int i = 0; i < cloth.midpoints.count(); ++i)
        problem.load[i] += cloth.midpoints.mass[i] * gravity - Vec3(clamps.row(i));
    for (const GhostSpring& spring : springs) {
        std::vector<std::pair<int, double>> point;
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(cloth.midpoints.ghost,
                                                                               spring.node);
             entry; ++entry)
            point.emplace_back(int(entry.col()), entry.value());
        add_spring(problem, point, spring.place, spring.stiffness);
    }
    return problem;
}

} // namespace toile
