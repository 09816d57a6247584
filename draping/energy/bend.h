// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Bending: a Morley plate whose edge slopes are read off the nodes around the edge.

#include "draping/algebra/block_matrix.h"
#include "draping/energy/patch.h"
#include "draping/fabric/fabric.h"

#include <Eigen/SparseCore>

namespace toile {

/// One triangle of the compact form, over its corners and the far corners of its neighbours.
struct BendElement {
    static constexpr int max_nodes = 6;
    int count = 0;
    std::array<int, max_nodes> nodes{};
    Eigen::Matrix<double, max_nodes, max_nodes>
        stiffness; ///< N/m; the Hessian is stiffness (x) I3; zero from `count` on
};

/// E = 1/2 sum_ij K_ij x_i . x_j, that is per area
///     1/2 (bend_warp |X_vv|^2 + bend_weft |X_uu|^2 + 2 c X_uu . X_vv + 4 bend_twist |X_uv|^2),
/// with X(u, v) the surface over (weft, warp) and c = bend_poisson sqrt(bend_warp bend_weft); an isotropic
/// plate has bend_twist = (1 - nu) D / 2. Second derivatives of positions, not angles: on cloth that keeps
/// its lengths both agree, and the energy is quadratic in positions, convex and rigid-motion invariant, with
/// a constant Hessian K (x) I3.
///
/// Second derivatives are those of Morley's triangle (quadratic; values at corners, slopes across mid-edges).
/// The slope is one vector per edge, seen by both triangles: linear in the nodes around the edge and exact on
/// quadratics. One value per edge makes the element consistent, exactness makes it convergent, on any mesh;
/// see docs/bending.md. Cloth that is curved at rest has RestCurvature besides.
struct Bending {
    Eigen::SparseMatrix<double> stiffness; ///< K: nodes x nodes, both halves, N/m
    /// The same with slopes from the two triangles at the edge alone: up to 15 % stiffer on rough meshes,
    /// with half the entries. Meant for what is factored; the energy is `stiffness`.
    std::vector<BendElement> compact;
};

/// The three second derivatives (X_uu, X_vv, X_uv) of one triangle: rows times the places of the nodes, the triangle's
/// corners first. Rows sum to zero. Where the rest shape is curved, they are covariant: less its Christoffel symbols times
/// the triangle's own first derivatives.
struct BendRows {
    std::vector<int> nodes;
    Eigen::Matrix<double, 3, Eigen::Dynamic> rows; ///< 1/m2
};
std::vector<BendRows> bend_rows(const Garment& garment);

/// Moduli of the energy per area over the second derivatives (uu, vv, uv). Throws std::invalid_argument for a fabric
/// whose bending is not positive definite.
Mat3 bend_moduli(const Fabric& fabric);

/// Stiffness against curving along a line at `angle` (rad) from the warp, N m.
double bend_modulus(const Fabric& fabric, double angle);

/// `fabrics` has one entry per panel. Throws as bend_moduli() does.
Bending make_bending(const Garment& garment, const std::vector<Fabric>& fabrics);

double bend_value(const Bending& bending, const Points& x);

/// Adds the gradient to `gradient`.
void bend_gradient(const Bending& bending, const Points& x, Points& gradient);

/// The same as one of the terms of an Energy, all of `stiffness`.
void add_gradient(const Bending& bending, const Points& x, Eigen::VectorXd& g);
void couplings(const Bending& bending, std::vector<std::pair<int, int>>& pairs);
void add_hessian(const Bending& bending, BlockMatrix& h);

} // namespace toile
