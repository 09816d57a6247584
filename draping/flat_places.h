// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Places looked up in the flat panels of a garment.

#include "geometry/bvh.h"
#include "sewing/garment.h"

namespace toile {

/// A panel, flat, to be looked up in: its triangles with area.
struct FlatPanel {
    std::vector<int> triangles; ///< of its garment
    Bvh tree;
};

/// Without triangles when the garment has none with area in this panel.
FlatPanel flat_panel(const Garment& garment, int panel);

/// The triangle of the garment that is nearest to a place of the panel, which has some.
int nearest_triangle(const Garment& garment, const FlatPanel& panel, const Vec2& at);

/// Coordinates of the place along the two edges of the triangle from its first corner; within it they and what is left of 1 are in [0, 1].
Vec2 place_in_triangle(const Garment& garment, int triangle, const Vec2& at);

/// Shares of the corners at the place; beyond the borders those of a place on them. Not negative, together 1.
Vec3 shares_in_triangle(const Garment& garment, int triangle, const Vec2& at);

} // namespace toile
