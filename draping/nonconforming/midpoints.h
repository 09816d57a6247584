// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth whose unknowns are the midpoints of edges: the nonconforming triangle of Crouzeix and Raviart (1973),
// as English and Bridson, Animating developable surfaces using nonconforming elements, 2008, use it for cloth
// that keeps its lengths. Triangles meet in the midpoints of their edges alone; contact and export see a
// conforming ghost mesh whose nodes are the garment's.

#include "draping/fabric/fabric.h"
#include "sewing/garment.h"

#include <Eigen/SparseCore>

namespace toile {

/// Numbered as Garment::edges.
struct Midpoints {
    std::vector<double>
        mass; ///< kg, a third of every triangle at the edge; on the border of one, half as much as inside
    /// Nodes x midpoints: a ghost node is the mean, weighted by mass, of the corners that the triangles around it
    /// have there, a corner of a triangle being the sum of the midpoints beside it less the one opposite. Rows sum to
    /// 1; that of a node without triangles is empty. By the weights, ghost nodes that have a third of the mass of
    /// every triangle around them have the momentum of the midpoints, whatever these do.
    Eigen::SparseMatrix<double, Eigen::RowMajor> ghost;

    int count() const { return int(mass.size()); }
};

/// `fabrics` has one entry per panel. Throws std::invalid_argument for a density that is not positive.
Midpoints make_midpoints(const Garment& garment, const std::vector<Fabric>& fabrics);

/// Midpoints of the straight edges between nodes. ghost_nodes() of them are the nodes again.
Points midpoints_of(const Garment& garment, const Points& nodes);

/// Positions, or velocities, of the ghost nodes. A node without triangles lies at the origin.
Points ghost_nodes(const Midpoints& midpoints, const Points& x);

/// Forces, or impulses, on ghost nodes as forces on midpoints: the transpose of the above, so that they do
/// the same work.
Points from_ghost_nodes(const Midpoints& midpoints, const Points& forces);

} // namespace toile
