// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A pattern from a surface that lines divide: pieces are cut out, flattened and joined by seams where they were one.

#include "geometry/lined_mesh.h"
#include "patterns/pattern.h"
#include "sewing/flatten.h"

namespace toile {

struct WantedPiece {
    std::string name;
    Vec3 inside; ///< the piece nearest to it
};

struct CutPiece {
    std::string name;
    TriMesh mesh;            ///< opened along lines that end inside it
    std::vector<int> source; ///< by point: that of the surface
    Flattened flat;
};

/// Throws std::invalid_argument naming the panel: two in one piece, a piece that is no disc.
std::vector<CutPiece> cut_out(const LinedMesh& surface, const std::vector<WantedPiece>& wanted, const FlattenOptions& options = {});

/// Panels that start out flat outside of where they were cut, facing as the surface does; outlines are cubic curves that stray
/// from the flattened borders by at most `fit` (m), and are divided alike on both sides of a seam. Both sides of a line are
/// sewn where both are wanted; seams carry the names of `lines`, by their numbers.
Pattern pattern_of(const LinedMesh& surface, const std::vector<CutPiece>& pieces, const std::vector<std::string>& lines, double fit = 3e-4);

} // namespace toile
