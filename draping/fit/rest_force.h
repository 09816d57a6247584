// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// How the forces of cloth change with its rest shape where its nodes stay. The membrane's law has corners where a triangle
// goes slack, near strain 0, where cloth that hangs mostly is, and a difference of rest shapes that is large enough to have
// digits steps over them. So the law is taken for its tangent, and only what is smooth is differenced.

#include "draping/cloth.h"

namespace toile {

/// A membrane's law at one state, per triangle.
struct MembraneTangent {
    std::vector<Vec3> strain;
    std::vector<StretchResponse> response;
};
MembraneTangent membrane_tangent(const Garment& garment, const PanelFabrics& fabrics, const Points& x);

/// The derivative by the nodes, N, of the energy of the cloth, its weight and its bands, stress being what `law` is to first
/// order. `loads` has the bands of this garment; `turn` as in StrainLimit.
Eigen::VectorXd rest_force(const Garment& garment, const PanelFabrics& fabrics, const Loads& loads, double turn,
                           const MembraneTangent& law, const Points& x);

} // namespace toile
