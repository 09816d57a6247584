// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sewing/garment.h"

namespace toile {

/// How the pattern lies in texture space: every panel moved, none turned or scaled by itself, so that
/// scale * vt + origin[panel] = grain coordinates (weft, warp) in metres.
struct UvLayout {
    double scale = 1;         ///< metres; one for the whole garment
    std::vector<Vec2> origin; ///< metres, per panel
};

/// Panels side by side on shelves in a square, 1 cm apart; every vt lies in [0, 1] and no two panels' boxes
/// overlap.
UvLayout lay_out_panels(const Garment& garment);

/// Texture coordinates of a vertex, u along the weft and v along the warp.
Vec2 texture_coordinates(const Garment& garment, const UvLayout& layout, int vertex);

} // namespace toile
