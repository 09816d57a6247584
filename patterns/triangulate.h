// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patterns/pattern.h"

#include <functional>

namespace toile {

struct TriangulateOptions {
    double edge_length = 0.01; ///< metres, target mean edge of the finest level
    /// Local factor on edge_length at a place of a panel, in (0, 1]; empty: 1 everywhere.
    std::function<double(int panel, const Vec2& at)> size;
    int levels = 1;     ///< nested levels, each twice as coarse as the next
    int smoothing = 10; ///< Lloyd iterations
    /// Inner points lie on a lattice along warp and weft of their panel, whose edges have that length, and stay there:
    /// edges along the yarns with a diagonal in every square, for methods that need them. Takes no `size`.
    bool grain_lattice = false;
};

/// Two border segments sewn to each other, start to start and end to end.
struct SewnSegment {
    std::array<int, 2> a{}, b{};
};

/// One triangulation of all panels. Vertices of different panels are distinct.
struct FlatLevel {
    double edge_length = 0;
    std::vector<Vec2> points; ///< panel coordinates, metres
    std::vector<int> panel_of_point;
    std::vector<Triangle> triangles; ///< front (counter-clockwise seen from there) is the fabric's right side
    std::vector<int> panel_of_triangle;
    /// Vertices along outline edge e of panel p, from the edge's start to its end: border[p][e].
    std::vector<std::vector<std::vector<int>>> border;
    /// The same places as fractions of the edge's arc length, 0 .. 1.
    std::vector<std::vector<std::vector<double>>> border_at;
    /// Vertices of seam s that are sewn to each other, in the order of its sides: stitches[s][k] = {a, b}.
    /// A dart's tip, sewn to itself, is left out.
    std::vector<std::vector<std::array<int, 2>>> stitches;
    /// The border segments of seam s in the order of its sides, a dart's tip included.
    std::vector<std::vector<SewnSegment>> sewn;
    /// Vertices along inner line l of panel p: lines[p][l]; of a cut, those on its left: the cloth on its
    /// right has vertices of its own.
    std::vector<std::vector<std::vector<int>>> lines;
};

/// A fine vertex as weights on a coarse triangle's corners (they sum to 1; slightly outside [0, 1] where a
/// curved border bulges beyond its coarse chord).
struct Interpolation {
    std::array<int, 3> from{};
    std::array<double, 3> weight{};
};

/// Cut cloth at nested levels, coarse to fine: the border samples of a level are every second one of the next
/// (single segments stay single), so that seams match on every level.
struct FlatPattern {
    std::vector<FlatLevel> levels;
    std::vector<std::vector<Interpolation>> prolongation; ///< [l][v]: vertex v of level l + 1 from level l
};

/// Throws std::runtime_error naming the panel when an outline cannot be triangulated (see check()), and
/// std::invalid_argument when an option is out of range or asks for more than 20 million triangles.
FlatPattern triangulate(const Pattern& pattern, const TriangulateOptions& options);

} // namespace toile
