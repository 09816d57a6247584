// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Springs along the edges of any triangulation and across them.

#include "draping/energy/springs.h"
#include "draping/fabric/fabric.h"
#include "sewing/garment.h"

namespace toile {

struct SpringMeshOptions {
    double damping_time = 0; ///< s, k_d / k_s
    /// From the fabric's limit on, the stiffness is so many times that before; 1: one phase.
    double beyond = 1;
};

/// Modulus of a narrow strip cut at `angle` (rad) from the warp, N/m.
double strip_modulus(const Fabric& fabric, double angle);

/// Largest elongation along a line at `angle` (rad) from the warp that the limits of the fabric allow when they are small:
/// that of warp, weft and shear at once. 0: any.
double strip_limit(const Fabric& fabric, double angle);

/// One spring per edge, k_s = sum E A / l^2 over its triangles, with E the strip modulus along the edge, A the triangle's area
/// and l the edge's length (Van Gelder: Approximate Simulation of Elastic Membranes by Triangulated Spring Meshes,
/// 1998); and one per inner edge between the corners opposite to it, so that the edge resists as a hinge of stiffness
/// B l^2 / (A_1 + A_2), B the bend modulus across it. Edges with three and more triangles bend freely, as do rest angles
/// other than 0. `fabrics` has one entry per panel.
std::vector<Spring> mesh_springs(const Garment& garment, const std::vector<Fabric>& fabrics,
                                 const SpringMeshOptions& options = {});

} // namespace toile
