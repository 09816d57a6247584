// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What a surface is cut along, and the pieces that are wanted: docs/cut.md.

#include "io/input_error.h"
#include "sewing/cut_pattern.h"

#include <optional>

namespace toile {

struct CutPlane {
    Vec3 on, normal;
    Eigen::AlignedBox3d box; ///< the line is drawn inside of it alone
};

struct CutLine {
    std::string name;
    Points points; ///< at least two; near the surface
    bool closed = false;
    std::optional<CutPlane> plane; ///< instead of points
};

struct CutLines {
    std::vector<CutLine> lines;
    std::vector<WantedPiece> panels;
};

/// Lengths in metres, in the coordinates of the body. Throws InputError.
CutLines read_cut_lines(const std::string& path);

/// Draws them, in their order. Ends of a line meet one that was drawn before where they are within 5 mm of it. Throws InputError, calling
/// the lines by `path` and their names, for one that meets no surface or comes to no end.
LinedMesh draw_lines(TriMesh surface, const CutLines& lines, const std::string& path);

} // namespace toile
