// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A surface that is told what lengths its edges and what angles its hinges are to have. The data exceed what a surface can
// follow by three per inner point, and rarely fit together: docs/rest.md.

#include "draping/energy/hinge.h"
#include "draping/energy/springs.h"
#include "draping/fabric/fabric.h"

namespace toile {

/// Lengths, angles and weights have one entry per edge of `edges`. An edge has the energy
///   length_weight (|e| / length - 1)^2 + angle_weight (theta - angle)^2,
/// theta as in hinge_angle(), which counts at edges with two triangles alone. Weights are 0 or more.
struct Prescribed {
    std::vector<Triangle> triangles;
    EdgeTable edges;
    std::vector<double> length; ///< m, more than 0
    std::vector<double> angle;  ///< rad
    std::vector<double> length_weight, angle_weight; ///< J
    int point_count = 0;
};

/// Lengths and angles as `points` have them, all weights 1. Throws std::invalid_argument for a triangle without area, named
/// by its points.
Prescribed measured(const std::vector<Triangle>& triangles, const Points& points);

/// Weights that make the energy that of a cloth of this fabric: half the mean stretch stiffness times a third of the area of
/// an edge's triangles, and the bending of a hinge.
void weigh(Prescribed& data, const Fabric& fabric);

/// The first triangle whose prescribed lengths no triangle has, since one is as long as the others together; -1: none.
int impossible_triangle(const Prescribed& data);

/// The energy of all data together, as any model of cloth.
class PrescribedEnergy final : public Energy {
public:
    explicit PrescribedEnergy(const Prescribed& data);

    double value(const Points& x) const override;
    void add_gradient(const Points& x, Eigen::VectorXd& g) const override;
    void couplings(std::vector<std::pair<int, int>>& pairs) const override;
    /// Projected: that of Gauss and Newton.
    void add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const override;

    const Springs& lengths() const { return lengths_; }
    const std::vector<HingeBend>& angles() const { return angles_; }

private:
    Springs lengths_;
    std::vector<HingeBend> angles_;
};

} // namespace toile
