// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What bending asks of cloth that is curved at rest, beyond what it asks of flat cloth.

#include "draping/energy/bend.h"

namespace toile {

/// With X_ij the second derivatives of a triangle of area A (BendRows), n its unit normal, k_ij its second fundamental form at
/// rest and C the moduli, cloth that is curved at rest has
///   1/2 A (X_ij - k_ij n) C (X_kl - k_kl n),
/// which is Bending's energy and E = 1/2 A k C k - n . sum_a weights_a x_a, where weights = A (C k)^T rows. Zero is the rest
/// shape; how docs/curved_rest.md.
struct RestCurvature {
    std::vector<int> nodes;      ///< the triangle's corners first
    std::vector<double> weights; ///< J/m, per node; they sum to zero
    double most = 0;             ///< J, 1/2 A k C k
};

/// Empty for a garment that is flat at rest. `fabrics` has one entry per panel. Throws as bend_moduli() does.
std::vector<RestCurvature> make_rest_curvature(const Garment& garment, const std::vector<Fabric>& fabrics);

/// A triangle without area has no normal, and counts as one across its curvature.
double value(const std::vector<RestCurvature>& curved, const Points& x);
void add_gradient(const std::vector<RestCurvature>& curved, const Points& x, Eigen::VectorXd& g);
/// Adds the product of the exact second derivative with v. There is no matrix of it: as a share of Bending's it is of the
/// order of an edge's length over the radius, of either sign, and couples nodes that a cheap factor leaves apart.
void add_product(const std::vector<RestCurvature>& curved, const Points& x, const Eigen::VectorXd& v,
                 Eigen::VectorXd& product);

} // namespace toile
