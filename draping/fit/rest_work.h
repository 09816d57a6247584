// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// How the forces of cloth change with its rest shape where its nodes stay, as work along a given motion. The membrane's
// law has corners where a triangle goes slack, near strain 0, where cloth that hangs mostly is, and a difference of rest
// shapes that is large enough to have digits steps over them. So only what is smooth is differenced, strains and areas, and
// the law's own tangent does the rest.

#include "draping/cloth.h"

namespace toile {

/// lambda . dE/dx of the cloth, its weight and its bands, taken apart.
struct RestWork {
    std::vector<Vec3> strain, rate;       ///< of each triangle, and how it changes along lambda
    std::vector<double> area;             ///< m2
    std::vector<StretchResponse> response;
    double smooth = 0;                    ///< J: all but the membrane
};

/// `loads` with the bands of this garment; `turn` as in StrainLimit.
RestWork rest_work(const Garment& garment, const PanelFabrics& fabrics, const Loads& loads, double turn, const Points& x,
                   const Points& lambda);

/// Derivative at `here` of lambda . dE/dx from two rest shapes on both sides of it, `step` apart from each other.
double slope(const RestWork& low, const RestWork& here, const RestWork& high, double step);

} // namespace toile
