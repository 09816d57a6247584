// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/nonconforming/midpoints.h"

#include <stdexcept>

namespace toile {

namespace {

/// kg per triangle.
std::vector<double> triangle_masses(const Garment& garment, const std::vector<Fabric>& fabrics) {
    std::vector<double> mass;
    for (std::size_t t = 0; t < garment.triangles.size(); ++t) {
        const Fabric& fabric = fabrics[garment.panel_of_triangle[t]];
        if (!(fabric.density > 0))
            throw std::invalid_argument("fabric \"" + fabric.name + "\": density must be positive");
        mass.push_back(fabric.density * rest_area(garment.rest.edges[t]));
    }
    return mass;
}

Eigen::SparseMatrix<double, Eigen::RowMajor> ghost_map(const Garment& garment,
                                                       const std::vector<double>& mass) {
    std::vector<double> around(garment.node_count, 0);
    for (int t = 0; t < int(garment.triangles.size()); ++t)
        for (int node : garment.nodes(t))
            around[node] += mass[t];
    std::vector<Eigen::Triplet<double>> entries;
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        const Triangle nodes = garment.nodes(t);
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k)
                entries.emplace_back(nodes[i], garment.edges.of_triangle[t][k],
                                     (k == i ? -1.0 : 1.0) * mass[t] / around[nodes[i]]);
    }
    Eigen::SparseMatrix<double, Eigen::RowMajor> ghost(garment.node_count, garment.edges.size());
    ghost.setFromTriplets(entries.begin(), entries.end());
    return ghost;
}

} // namespace

Midpoints make_midpoints(const Garment& garment, const std::vector<Fabric>& fabrics) {
    Midpoints m;
    const std::vector<double> mass = triangle_masses(garment, fabrics);
    m.mass.assign(garment.edges.size(), 0);
    for (std::size_t t = 0; t < mass.size(); ++t)
        for (int e : garment.edges.of_triangle[t])
            m.mass[e] += mass[t] / 3;
    m.ghost = ghost_map(garment, mass);
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
