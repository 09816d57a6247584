// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cut cloth that follows its outline as that is altered: the same mesh, whose borders stay at their fractions of the
// edges and whose inner points move with them by a fixed linear map, so that all is smooth in the amounts.

#include "patterns/alter.h"
#include "patterns/triangulate.h"

namespace toile {

/// One panel at one level.
struct MovingPanel {
    int panel = 0;
    std::vector<int> border;  ///< points that lie where they are told: the outline's, then holes' and inner lines'
    std::vector<int> inside;  ///< the others
    Eigen::MatrixXd weight;   ///< inside x border: harmonic (cotangent) weights, exact for affine moves
};

/// A pattern, its triangulation and how it may be altered.
struct MovingFlat {
    Pattern drawn;
    FlatPattern flat; ///< of the pattern as drawn
    std::vector<Alteration> alterations;
    std::vector<std::vector<MovingPanel>> panels; ///< by level: those that an alteration moves
};

/// Holes and inner lines stay where they are, since a pattern file says them apart from outlines.
MovingFlat moving_flat(Pattern drawn, FlatPattern flat, std::vector<Alteration> alterations);

/// Points of a level where the outlines of `pattern`, an altered one, take them.
std::vector<Vec2> moved_points(const MovingFlat& moving, const Pattern& pattern, int level);

/// The triangulation of an altered pattern, all levels.
FlatPattern moved_flat(const MovingFlat& moving, const Pattern& pattern);

/// The first triangle of a level that has less than `least` of its area as drawn; -1 when none.
int collapsed_triangle(const MovingFlat& moving, const std::vector<Vec2>& points, int level, double least);

} // namespace toile
