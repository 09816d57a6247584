// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Where the samples of outlines, holes and inner lines lie, and which of them are sewn to each other: the
// part of triangulation that has to be right before a mesher sees the panels.

#include "patterns/triangulate.h"

namespace toile {

enum class BorderKind { outline, hole, line };

/// One curved edge of a panel and the places, as fractions of its arc length, where it is cut because a span
/// ends there or ends opposite, across a seam. cuts starts with 0 and ends with 1.
struct BorderTrack {
    BorderKind kind = BorderKind::outline;
    int panel = 0;
    int loop = 0;  ///< index into Panel::holes or Panel::lines; 0 for the outline
    int index = 0; ///< edge within its loop
    Edge edge;
    double length = 0; ///< metres
    std::vector<double> cuts;
    int first_interval = 0; ///< intervals first_interval + k lie between cuts k and k + 1
};

/// The stretch of a track between two cuts. It is sampled as one, like every interval of its group.
struct BorderInterval {
    int track = 0;
    double t0 = 0, t1 = 1;
    int group = 0;
    bool reversed = false;    ///< runs against the group's direction
    std::vector<double> at;   ///< samples of the finest level as fractions of the track, from t0 to t1
    std::vector<Vec2> points; ///< where they lie
};

/// Intervals that seams connect, directly or in a chain. All carry the same number of segments at the same
/// fractions: base * 2^halvings at the finest level, half as many on each coarser one until base is reached.
struct BorderGroup {
    int base = 1;
    int halvings = 0;
    std::vector<int> members; ///< intervals, ascending
    bool symmetric = false;   ///< an interval is sewn to itself turned round
    bool single = false;      ///< one segment on every level: between two points of a rest mesh
};

/// Two intervals sewn to each other; `backward`: the seam walks the interval from t1 to t0.
struct SewnIntervals {
    int a = 0, b = 0;
    bool a_backward = false, b_backward = false;
};

/// The end of an inner line that lies on another edge of its panel shares that edge's sample.
struct LineEnd {
    int track = 0; ///< first or last track of the line
    bool last = false;
    int on_track = 0; ///< where it lies, at cut `t`
    double t = 0;
};

struct BorderPlan {
    int levels = 1;
    std::vector<BorderTrack> tracks; ///< panel by panel: outline, holes, lines
    std::vector<int> first_track;    ///< panel p has tracks first_track[p] .. first_track[p + 1]
    std::vector<BorderInterval> intervals;
    std::vector<BorderGroup> groups;
    std::vector<std::vector<SewnIntervals>> seams; ///< per seam, in the order of its sides
    std::vector<LineEnd> line_ends;

    /// Number of segments of a group at level l, 0 being the coarsest.
    int count(int group, int level) const;
};

/// Least number of segments wanted of a group at a level: wanted[level][group].
using LeastCounts = std::vector<std::vector<int>>;

/// Cuts all edges so that the intervals on both sides of every seam correspond one to one, and groups them. Edges of rest
/// meshes are cut at all of their points, and nowhere else. Counts are not chosen yet. Throws std::runtime_error with a
/// sentence when a seam has no length, when overlapping seams ask for ever more cuts, or one for a point that a rest mesh
/// has not.
BorderPlan plan_borders(const Pattern& pattern, const TriangulateOptions& options);

/// Chooses every group's counts and samples its intervals: nearest to the target length on the finest level,
/// and as near as nesting allows on the coarser ones, never below `least`; curves stray from their chords by
/// at most an eighth of the target.
void choose_counts(BorderPlan& plan, const TriangulateOptions& options, const LeastCounts& least);

} // namespace toile
