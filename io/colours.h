// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The shades that tell panels apart, the same in MTL, GLB and preview.

#include "geometry/types.h"

namespace toile {

/// Linear RGB in [0, 1] of a panel's right side: one blue cloth in slightly different shades, so that
/// neighbours in the file's order differ.
Vec3 panel_colour(int panel);

/// Linear RGB of the body.
Vec3 body_colour();

/// Linear light to the display's encoding (IEC 61966-2-1).
double srgb(double linear);

} // namespace toile
