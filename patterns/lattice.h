// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patterns/panel_mesh.h"
#include "patterns/plane.h"

namespace toile {

/// Points in rows: seeds for a triangulation.
struct Lattice {
    Vec2 origin = Vec2::Zero();
    Vec2 along = Vec2::UnitX(); ///< unit, direction of the rows
    double spacing = 1;         ///< m, of the points of a row
    double height = 1;          ///< m, of the rows
    double shift = 0;           ///< of every second row, in spacings

    /// (along the rows, across them) from the origin.
    Vec2 local(const Vec2& p) const { return {along.dot(p - origin), cross(along, p - origin)}; }
    Vec2 point(int row, int column) const {
        const Vec2 q{(column + (row % 2 != 0 ? shift : 0.0)) * spacing, row * height};
        return origin + q.x() * along + q.y() * Vec2(-along.y(), along.x());
    }
    double column_at(int row, double x) const { return x / spacing - (row % 2 != 0 ? shift : 0.0); }
};

/// Equilateral triangles. The lattice follows the directions (modulo 60 degrees) that most of the border has, so that
/// most of the border meets whole rows.
Lattice hexagonal_lattice(const PanelBorder& border, double spacing);

/// Rectangles along warp and weft, `grain` as in Panel. They take place and spacing from the longest straight stretches
/// of border along these directions, where those are sampled no more than a third off `spacing`, so that a panel
/// cut along its grain has no other triangles than halves of such rectangles.
Lattice grain_lattice(const PanelBorder& border, double spacing, double grain);

/// Lattice points inside the outline and at least `off` (m) from every segment.
std::vector<Vec2> lattice_seeds(const PanelBorder& border, const Lattice& lattice, double off);

} // namespace toile
