// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/fabric/stretch_curve.h"

namespace toile {

/// What a cloth weighs and resists, per area or length, in its grain directions. SI units.
///
/// Bending energy per area, with k_u and k_v the curvatures along warp and weft and k_uv the twist:
///   1/2 (bend_warp k_u^2 + bend_weft k_v^2 + 2 c k_u k_v + 4 bend_twist k_uv^2),
///   c = bend_poisson sqrt(bend_warp bend_weft).
/// A sheet of stiffness D that is the same in all directions has bend_twist = D (1 - bend_poisson) / 2, and the
/// stiffness measured at 45 degrees is (bend_warp + bend_weft + 2 c + 4 bend_twist) / 4.
struct Fabric {
    std::string name;
    double density = 0;        ///< kg/m2
    double stretch_warp = 0;   ///< N/m, of a strip pulled along the warp and free to contract
    double stretch_weft = 0;   ///< N/m
    /// Of a knit (warp: along its wales, weft: along its courses) instead of constant stiffness; empty: that. Given by
    /// set_warp_curve() and set_weft_curve(), since models that have no curves go by the numbers above (docs/methods.md).
    std::vector<StretchPoint> curve_warp, curve_weft;
    double poisson = 0;        ///< major Poisson ratio: contraction of the weft under warp tension, [0, 0.5)
    double shear = 0;          ///< N/m per rad of shear angle
    double bend_warp = 0;      ///< N m, resistance to curving a warp yarn
    double bend_weft = 0;      ///< N m
    double bend_twist = 0;     ///< N m
    double bend_poisson = 0;   ///< coupling of the two curvatures, [0, 0.5)
    double compression = 0.5;  ///< stiffness under compression, as a share of that under tension, (0, 1]
    double thickness = 0;      ///< m
    double friction = 0;       ///< Coulomb coefficient on the body
    double cloth_friction = 0; ///< and of the cloth on itself
    double limit_warp = 0;     ///< largest stretch, e.g. 0.01
    double limit_weft = 0;
    double limit_shear = 0;    ///< locking angle of shear, rad
    std::string source;        ///< where the figures come from
};

/// Where a model has no curves, the secant at this stretch stands for one: about the most that garments at rest are stretched by.
constexpr double secant_stretch = 0.1;

/// The curve, and the number that stands for it. Throw std::invalid_argument as membrane_curve().
void set_warp_curve(Fabric& fabric, std::vector<StretchPoint> points);
void set_weft_curve(Fabric& fabric, std::vector<StretchPoint> points);

/// Presets by name: poplin denim silk wool linen leather jersey rib.
const std::vector<Fabric>& fabric_presets();

/// Throws std::invalid_argument that lists the names when there is no such preset.
const Fabric& fabric_preset(const std::string& name);

} // namespace toile
