// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth whose yarns keep their lengths (Goldenthal, Harmon, Fattal, Bercovier, Grinspun: Efficient Simulation of Inextensible
// Cloth, 2007): which edges of a mesh are yarns, and what the cloth resists beside.

#include "draping/energy/bend.h"
#include "draping/energy/grain.h"
#include "draping/energy/hinge.h"
#include "draping/energy/tension.h"

namespace toile {

/// Edges that lie along warp or weft of some triangle, within two degrees, by that triangle's panel. Left out are eased
/// ones, of which triangles differ by more than 2 % in length. On a mesh cut by TriangulateOptions::grain_lattice these are
/// about two for every node, and diagonals and edges to a border across the grain are none. Throws std::invalid_argument
/// when they are not fewer than the three coordinates per node, less the six of a rigid motion: nothing could move.
std::vector<LengthConstraint> yarn_edges(const Garment& garment);

/// Shear, bending, creases, tension of the yarns; and stretch of triangles along warp or weft where they have no edge that is a yarn
/// in that direction. Of a GrainTriangle of area A, e = (T^T T - I) / 2 its strain:
/// E = A / 2 (k_weft e_uu^2 + k_warp e_vv^2 + shear (2 e_uv)^2). No coupling of warp and weft; 2 e_uv is the sine of the
/// shear angle where both keep their lengths.
class YarnCloth final : public Energy {
public:
    /// `fabrics` has one entry per panel.
    YarnCloth(const Garment& garment, const std::vector<Fabric>& fabrics, std::vector<LengthConstraint> yarns);

    Tension tension;

    double value(const Points& x) const override;
    void add_gradient(const Points& x, Eigen::VectorXd& g) const override;
    void couplings(std::vector<std::pair<int, int>>& pairs) const override;
    /// Projected: stress that pushes is left out of what turns a triangle, and shear has the part of its slope alone.
    void add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const override;
    bool take_up(const Points& x) override { return tension.take_up(x); }

private:
    std::vector<GrainTriangle> triangles_;
    Bending bending_;
    std::vector<HingeBend> creases_;
};

} // namespace toile
