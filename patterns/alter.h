// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Alterations: named amounts by which points of outlines move, as a pattern cutter writes them on a pattern.

#include "patterns/pattern.h"

#include <Eigen/Core>

namespace toile {

/// A point of a panel's outline: a vertex, the start of `edge` and the end of the one before it, or a control point of the
/// edge's curve.
struct OutlinePoint {
    int panel = 0, edge = 0;
    int control = 0; ///< 0: the vertex; 1, 2: the edge's first, second control point
};

/// By `step` metres (panel coordinates) for every metre of the alteration.
struct OutlineMove {
    OutlinePoint point;
    Vec2 step = Vec2::Zero();
};

struct Alteration {
    std::string name;
    std::vector<OutlineMove> moves;
    double low = 0, high = 0; ///< m, bounds of its amount; 0 is the pattern as drawn
};

/// The pattern with every alteration done by its amount (m). A curve goes along with its chord: control points keep their
/// places relative to it, and an arc its angle, before they move themselves. Throws std::invalid_argument when the numbers
/// differ or a point does not exist.
Pattern altered(const Pattern& pattern, const std::vector<Alteration>& alterations, const Eigen::VectorXd& amounts);

// What a pattern cutter alters. Each throws std::invalid_argument, a sentence, when there is no such thing.

/// Edge longer by 1 m, its start staying: its end moves along the chord.
std::vector<OutlineMove> lengthen_edge(const Pattern& pattern, int panel, int edge);
/// The edge moves outward by 1 m, square to its chord, with both its ends.
std::vector<OutlineMove> move_edge(const Pattern& pattern, int panel, int edge);
/// The dart of edges `edge` and the next, tip between them, wider by 1 m at its mouth.
std::vector<OutlineMove> widen_dart(const Pattern& pattern, int panel, int edge);
/// The seam moves by 1 m into the panels of its side b: what side a gains outward, b loses. Both sides of one edge each.
std::vector<OutlineMove> move_seam(const Pattern& pattern, int seam);

} // namespace toile
