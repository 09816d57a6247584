// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/nonconforming/midpoints.h"

#include <Eigen/LU>

#include <stdexcept>

namespace toile {

namespace {

Eigen::SparseMatrix<double, Eigen::RowMajor> ghost_map(const Garment& garment) {
    std::vector<int> corners(garment.node_count, 0);
    for (int t = 0; t < int(garment.triangles.size()); ++t)
        for (int node : garment.nodes(t))
            ++corners[node];
    std::vector<Eigen::Triplet<double>> entries;
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        const Triangle nodes = garment.nodes(t);
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k)
                entries.emplace_back(nodes[i], garment.edges.of_triangle[t][k],
                                     (k == i ? -1.0 : 1.0) / corners[nodes[i]]);
    }
    Eigen::SparseMatrix<double, Eigen::RowMajor> ghost(garment.node_count, garment.edges.size());
    ghost.setFromTriplets(entries.begin(), entries.end());
    return ghost;
}

} // namespace

Midpoints make_midpoints(const Garment& garment, const std::vector<Fabric>& fabrics) {
    Midpoints m;
    m.mass.assign(garment.edges.size(), 0);
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        const Fabric& fabric = fabrics[garment.panel_of_triangle[t]];
        if (!(fabric.density > 0))
            throw std::invalid_argument("fabric \"" + fabric.name + "\": density must be positive");
        const double mass = fabric.density * rest_area(garment.rest.edges[t]);
        for (int e : garment.edges.of_triangle[t])
            m.mass[e] += mass / 3;
    }
    m.ghost = ghost_map(garment);
    return m;
}

Points midpoints_of(const Garment& garment, const Points& nodes) {
    Points x;
    x.reserve(garment.edges.size());
    for (const auto& [a, b] : garment.edges.ends)
        x.push_back((nodes[a] + nodes[b]) / 2);
    return x;
}

Points ghost_nodes(const Midpoints& midpoints, const Points& x) {
    Points nodes(midpoints.ghost.rows(), Vec3::Zero());
    for (int i = 0; i < int(nodes.size()); ++i)
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(midpoints.ghost, i); entry;
             ++entry)
            nodes[i] += entry.value() * x[entry.col()];
    return nodes;
}

Points from_ghost_nodes(const Midpoints& midpoints, const Points& forces) {
    Points on_midpoints(midpoints.count(), Vec3::Zero());
    for (int i = 0; i < int(forces.size()); ++i)
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(midpoints.ghost, i); entry;
             ++entry)
            on_midpoints[entry.col()] += entry.value() * forces[i];
    return on_midpoints;
}

} // namespace toile
