// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Alterations: named amounts by which points of outlines move, as a pattern cutter writes them on a pattern, or by which
// elastics and the rest lengths of cloth change.

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

/// The ratio of an elastic grows by `ratio` for every unit of the alteration.
struct ElasticMove {
    int elastic = 0;
    double ratio = 0;
};

/// Panel::shrink grows by `share` (weft, warp) for every unit of the alteration.
struct ShrinkMove {
    int panel = 0;
    Vec2 share = Vec2::Zero();
};

/// Side a of a seam may be longer by `length` metres for every unit of the alteration than side b as the two are drawn. It moves
/// nothing; alterations that do are freed by it from keeping the seam as drawn.
struct EaseMove {
    int seam = 0;
    double length = 0;
};

struct Alteration {
    std::string name;
    std::vector<OutlineMove> moves;
    double low = 0, high = 0; ///< bounds of its amount, m or shares; 0 is the pattern as drawn
    std::vector<ElasticMove> elastics{};
    std::vector<ShrinkMove> shrinks{};
    std::vector<EaseMove> eases{};
    bool share = false; ///< its amount is a share of lengths and not one in metres
};

/// An amount as specs, tables and sentences have it: mm, or percent.
double in_unit(const Alteration& alteration, double amount);
const char* unit_of(const Alteration& alteration);

/// The pattern with every alteration done by its amount. A curve goes along with its chord: control points keep their
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
/// These elastics are longer by 1 m together when they are relaxed, each by the same share of the cloth, whose lengths are those
/// of `pattern` at rest.
std::vector<ElasticMove> lengthen_elastics(const Pattern& pattern, const std::vector<int>& elastics);
/// The seam moves by 1 m into the panels of its side b: what side a gains outward, b loses. Both sides of one edge each.
std::vector<OutlineMove> move_seam(const Pattern& pattern, int seam);

} // namespace toile
