// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A drape handed on to another mesh of the same pattern, or of nearly the same.

#include "sewing/garment.h"

namespace toile {

/// Where the nodes of `to` lie on the surface that `from` has at x: every vertex looks up its place in the flat panel
/// of `from` that panel_of names for its own panel, and a node of several vertices takes their mean. Beyond the border
/// of that panel the plane of its nearest triangle is continued. Every panel_of[p] must have a triangle with area.
Points carry_drape(const Garment& from, const Points& x, const Garment& to, const std::vector<int>& panel_of);

/// Whether a panel has a triangle with area, on which places can be looked up.
bool can_carry(const Garment& from, int panel);

} // namespace toile
