// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// How far cloth gives: one-sided limits on the stretch of warp and weft and on the angle of shear.

#include "draping/energy/stretch.h"

namespace toile {

/// One triangle. With yarns F_weft, F_warp the images of the unit grain directions under the triangle's
/// linear map: |F|^2 < (1 + limit)^2 for each yarn, and (F_weft . F_warp)^2 < sin^2(limit) (|F_weft|^2
/// |F_warp|^2 + tiny). Chords, not arcs, since the strain of the written mesh is what is promised. A limit of
/// 0 in the fabric means none. Each of the three is a barrier of s = (how far - 0.6) / 0.4, `stiffness` times
/// -s^2 log(1 - s): nothing below 60 % of the limit, twice continuously differentiable, infinite at it.
struct StrainLimit {
    std::array<int, 3> nodes{};
    Eigen::Matrix<double, 3, 2> shape; ///< F = [x0 x1 x2] shape, columns weft and warp, 1/m
    double weft = 0, warp = 0;         ///< largest |F|^2; infinity: none
    double shear = 0;                  ///< largest sine squared of the shear angle; infinity: none
    double weft_stiffness = 0, warp_stiffness = 0, shear_stiffness = 0; ///< J
};

std::vector<StrainLimit> make_strain_limits(const Garment& garment, const std::vector<Fabric>& fabrics);

/// Widens every limit that x violates or comes closer to than `margin` (as a share of the limit, e.g. 0.05),
/// so that x becomes feasible. Returns the number of triangles changed.
int widen_strain_limits(std::vector<StrainLimit>& limits, const Points& x, double margin);

/// Infinity where a limit is reached or passed.
double strain_limit_value(const std::vector<StrainLimit>& limits, const Points& x);
double strain_limit_value(const StrainLimit& limit, const Points& x);

/// Adds the gradient to `gradient`.
void strain_limit_gradient(const std::vector<StrainLimit>& limits, const Points& x, Points& gradient);

/// False, and `hessian` untouched, where no limit acts. Rows and columns in the order of limit.nodes.
bool strain_limit_hessian(const StrainLimit& limit, const Points& x, HessianKind kind,
                          Eigen::Matrix<double, 9, 9>& hessian);

/// Largest step in [0, 1] such that no limit is reached before it on the way from x along `direction` (nodes
/// may then stand on a limit: take a fraction of it). `where`, when given, receives the triangle that stops
/// it, or -1.
double strain_limit_step(const std::vector<StrainLimit>& limits, const Points& x, const Points& direction,
                         int* where = nullptr);

} // namespace toile
