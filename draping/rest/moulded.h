// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth that has taken the shape of a form: a cup pressed in a mould, a brim, felt, a shape found for lengths and angles.

#include "sewing/garment.h"

namespace toile {

/// The rest shape with which `garment` is at rest with its nodes at `x` (m): the sheet of equilibrium has no energy there.
/// The grain stays where it was but for the shear of moulding; creases get the angle they have at `x`. Rest edges are
/// lengths along the smooth surface, as the membrane counts edges, not chords. Throws std::invalid_argument for a triangle
/// without area, at `x` or in the garment's rest shape, named by its number.
RestShape moulded(const Garment& garment, const Points& x);

} // namespace toile
