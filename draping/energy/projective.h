// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth for local/global solvers (Bouaziz, Martin, Liu, Kavan, Pauly: Projective Dynamics, 2014): every part of its energy is
// the square of a distance between something linear in the nodes and a set that it is easily projected to.

#include "draping/energy/bend.h"
#include "draping/energy/energy.h"

namespace toile {

/// An energy whose second derivative nowhere exceeds a constant matrix. For one of projections that is the matrix of the
/// global step, and the local step is the gradient.
class BoundedEnergy : public Energy {
public:
    virtual void add_bound(BlockMatrix& h) const = 0;
};

/// Lines drawn on a triangle, w = [x0 x1 x2] shape the image of a unit vector along them: E = 1/2 stiffness (|w| - 1)^2, the
/// square of the distance of w from the unit sphere.
struct DirectionSpring {
    std::array<int, 3> nodes{};
    Vec3 shape;           ///< 1/m
    double stiffness = 0; ///< N/m times area, J
};

/// Weft, warp and the two directions between them in every triangle. The latter have twice the fabric's shear stiffness G; for
/// small strains e they add G (e_weft + e_warp)^2 / 2 per area to its shear, of which the terms of one yarn are taken off
/// those of the yarns (to no less than a tenth), and the term of both is a Poisson effect of G / k. Bending is that of
/// the default (bend.h), quadratic in the nodes.
class ProjectiveCloth final : public BoundedEnergy {
public:
    /// `fabrics` has one entry per panel.
    ProjectiveCloth(const Garment& garment, const std::vector<Fabric>& fabrics);

    double value(const Points& x) const override;
    void add_gradient(const Points& x, Eigen::VectorXd& g) const override;
    void couplings(std::vector<std::pair<int, int>>& pairs) const override;
    void add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const override;
    void add_bound(BlockMatrix& h) const override;

private:
    template <class Block>
    void add_elements(BlockMatrix& h, const Block& block) const;

    std::vector<DirectionSpring> springs_;
    Bending bending_;
};

} // namespace toile
