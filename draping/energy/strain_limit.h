// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// How far cloth gives: one-sided limits on the stretch of warp and weft and on the angle of shear.

#include "draping/energy/grain.h"
#include "draping/energy/stretch.h"

namespace toile {

/// One triangle. With yarns F_weft, F_warp the images of the unit grain directions under the triangle's
/// linear map: |F|^2 < (1 + limit)^2 for each yarn, and (F_weft . F_warp)^2 < sin^2(limit) (|F_weft|^2
/// |F_warp|^2 + tiny). Chords, not arcs, since the strain of the written mesh is what is promised. A limit of
/// 0 in the fabric means none. Each of the three acts on s = (how far - 0.6) / 0.4: nothing below 60 % of the
/// limit, then `stiffness` times the barrier -s^2 log(1 - s), and from s = turn on the quadratic that continues
/// it. Twice continuously differentiable and finite, so that cloth may be beyond a limit on its way; the nearer
/// `turn` to 1, the harder the limit. At 0.7 the cloth has at the limit about twenty times the tension that
/// its membrane alone would have.
struct StrainLimit {
    std::array<int, 3> nodes{};
    GrainShape shape; ///< F = [x0 x1 x2] shape
    double weft = 0, warp = 0;         ///< largest |F|^2; infinity: none
    double shear = 0;                  ///< largest sine squared of the shear angle; infinity: none
    double turn = 0.7;
    double weft_stiffness = 0, warp_stiffness = 0, shear_stiffness = 0; ///< J
};

std::vector<StrainLimit> make_strain_limits(const Garment& garment, const std::vector<Fabric>& fabrics);

/// The triangles that are at or beyond one of their limits, in rising order.
std::vector<int> beyond_strain_limits(const std::vector<StrainLimit>& limits, const Points& x);

double strain_limit_value(const std::vector<StrainLimit>& limits, const Points& x);
double strain_limit_value(const StrainLimit& limit, const Points& x);

/// Adds the gradient to `gradient`.
void strain_limit_gradient(const std::vector<StrainLimit>& limits, const Points& x, Points& gradient);

/// False, and `hessian` untouched, where no limit acts. Rows and columns in the order of limit.nodes.
bool strain_limit_hessian(const StrainLimit& limit, const Points& x, HessianKind kind,
                          Eigen::Matrix<double, 9, 9>& hessian);

} // namespace toile
