// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Bending of cloth on edge midpoints: curvature as the divergence of slopes that neighbours share.

#include "draping/fabric/fabric.h"
#include "sewing/garment.h"

#include <Eigen/SparseCore>

namespace toile {

/// An edge, of one or two triangles, at which cloth is held at a slope. Its midpoint is to be held as well,
/// best by a spring (add_spring) as stiff as the mean diagonal entry of the stiffness: midpoints that are
/// fixed along a line can make lengths depend on each other, and some meshes then have no balance of finite
/// tensions.
struct Clamp {
    int edge = 0;
    /// Derivative of position by (weft, warp) of the first triangle at the edge: two orthonormal columns.
    Eigen::Matrix<double, 3, 2> slope;
};

/// E = 1/2 sum |rows x + offset|^2, the energy per area of Fabric in second derivatives of position, as of
/// Bending: quadratic in positions, convex, with a constant Hessian stiffness (x) I3.
///
/// On a triangle the gradient G of the nonconforming function is constant. The slope g_e at the middle of an
/// edge is a weighted sum of the gradients of the triangles around the edge, of the smallest weights that are
/// exact where gradients are linear, and both triangles at the edge see the same; so the second derivative H
/// = 1/A sum |e| g_e n_e^T is exact on quadratics, and its integral depends on slopes at the border alone
/// (the patch test). Either without the other does not converge. H alone leaves triangles free to turn
/// against each other, so what g_e leaves of G + H (x - centroid) at the middle of each edge of each triangle
/// is held with stiffness 2 D |e|^2 / (A1 + A2), which a quadratic does not feel. Jumps of G alone (English
/// and Bridson's energy) are felt by curved cloth as well; see docs/nonconforming.md. A smooth surface is
/// represented by its means over edges, not its values in their middles. Rest angles are not taken into
/// account, and an edge of three or more triangles is a hinge.
struct MidpointBending {
    Eigen::SparseMatrix<double> rows;                ///< scaled by the roots of areas and moduli
    Eigen::Matrix<double, Eigen::Dynamic, 3> offset; ///< what clamps contribute
    Eigen::SparseMatrix<double> stiffness;           ///< rows^T rows: midpoints x midpoints, both halves, N/m
    /// Jumps of gradients alone, 3 D |e|^2 / (A1 + A2): of the same order, with a tenth of the entries. Meant for what is factored.
    Eigen::SparseMatrix<double> compact;
};

/// `fabrics` has one entry per panel. Throws std::invalid_argument for a fabric whose bending is not positive
/// definite and for a clamp at an edge that does not exist.
MidpointBending make_midpoint_bending(const Garment& garment, const std::vector<Fabric>& fabrics,
                                      const std::vector<Clamp>& clamps = {});

double bend_value(const MidpointBending& bending, const Points& x);

/// The gradient.
Points bend_gradient(const MidpointBending& bending, const Points& x);

} // namespace toile
