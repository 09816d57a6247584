// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Panels of a garment that can only move as one.

#include "sewing/garment.h"

namespace toile {

/// Panels that share nodes: one panel each, unless seams are closed already.
struct Piece {
    std::vector<int> panels;    ///< ascending
    std::vector<int> triangles; ///< of the garment
    std::vector<int> nodes;     ///< ascending
    Vec3 normal = Vec3::Zero(); ///< mean, of the right side, unit
    double area = 0;            ///< m2
    double flatness = 0;        ///< length of the mean normal over unit ones: 1 flat, about 0 closed round
    Vec3 middle = Vec3::Zero(); ///< by area
};

/// In the order of their first panels.
std::vector<Piece> pieces_of(const Garment& garment, const Points& x);

/// Whether a piece has a panel that is marked; nothing is when `marked` is empty.
bool any_of_panels(const Piece& piece, const std::vector<bool>& marked);

} // namespace toile
