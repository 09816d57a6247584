// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth by triangles as Baraff and Witkin have it (Large Steps in Cloth Simulation, 1998): stretch of warp and weft each
// by itself, the angle between them, and hinges.

#include "draping/energy/constraint.h"
#include "draping/energy/grain.h"
#include "draping/energy/hinge.h"

#include <memory>

namespace toile {

/// A triangle whose fabric may have measured curves, here by S.
struct CurvedTriangle : GrainTriangle {
    double area = 0; ///< m2
    std::shared_ptr<const std::array<StretchCurve, 2>> curves; ///< of weft and warp; null: constant stiffness
};

/// Of a GrainTriangle of area A: with S_u = |T u| - 1 for the unit directions u of weft and warp,
/// E = A / 2 (k_weft S_weft^2 + k_warp S_warp^2 + shear gamma^2), gamma the departure of the angle between T weft and T warp
/// from 90 degrees. No coupling of warp and weft (no Poisson effect); compression as stiff as tension. A measured curve has its
/// own energy at S in place of 1/2 k S^2; as a constraint, it has the secant stiffness of the moment, whose force is the curve's.
///
/// Each of these conditions C, of stiffness k, is damped by itself: forces -k_d (dC/dx) C', k_d = `damping_time` (s) times k.
class TriangleCloth final : public ConstraintEnergy {
public:
    /// `fabrics` has one entry per panel.
    TriangleCloth(const Garment& garment, const std::vector<Fabric>& fabrics, double damping_time = 0);

    double value(const Points& x) const override;
    void add_gradient(const Points& x, Eigen::VectorXd& g) const override;
    void couplings(std::vector<std::pair<int, int>>& pairs) const override;
    void add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const override;
    void add_damping(const Points& x, const Points& v, Eigen::VectorXd& force) const override;
    void add_damping_matrix(const Points& x, double factor, BlockMatrix& h) const override;
    /// S_weft, S_warp and gamma of every triangle, then the turn of every hinge.
    int constraint_count() const override { return int(3 * triangles_.size() + bends_.size()); }
    Constraint constraint(int k, const Points& x) const override;

private:
    std::vector<CurvedTriangle> triangles_;
    std::vector<HingeBend> bends_;
    double damping_time_;
};

} // namespace toile
