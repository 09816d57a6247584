// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Seams of the coarsest level pulled shut round the body, from one start and in one way. Internal to the
// stages of a drape.

#include "draping/drape_run.h"
#include "draping/place.h"
#include "draping/wait.h"

namespace toile {

inline constexpr double weld_gap = 2e-4;     ///< m, below which a seam is closed for good
inline constexpr double forced_share = 0.05; ///< of the edge length: a gap below which a seam may be joined by force

/// A start of the coarsest level.
struct Start {
    double lift = 0; ///< m, by which the garment was moved up as a whole
    PlacedClear placed;
    std::vector<bool> wrapped = {}; ///< by panel: was laid round the body instead; empty: none
};

/// How seams are closed.
struct Sewing {
    bool self = true; ///< with contact between panels
    bool hooks = true; ///< carrying edges are held at their height; never where the garment was moved up or down
    std::vector<char> first = {}; ///< by seam: these close before the others; empty: all at once
    Waiting waiting = {};  ///< until the other seams are closed and the cloth hangs, and are then
    bool careful = false;  ///< sewn one stitch at a time
};

struct Sewn {
    Start start;
    Sewing way;
    Points x;                ///< nodes of the open garment
    double gap = 0;          ///< m, the widest that is left
    int crossings = 0;       ///< pairs of triangles of the closed garment
    bool open = false;       ///< it is too wide to be joined
    DrapeStatus status = DrapeStatus::stalled; ///< if it is open, and
    std::string where = {};  ///< what keeps it so
};

/// Pulls all seams of the open garment shut: those that do not wait, then, by the weight of what hangs from
/// them and stitch by stitch, those that do. The gaps that stay are in the result, not an error.
Sewn pull_shut(DrapeRun& run, const Start& start, const Sewing& way);

/// Merges the nodes of closed seams: `map` has the node of `closed` for every one of x. Every group of nodes
/// goes to its mean.
Points merge(const Garment& closed, const std::vector<int>& map, const Points& x);

/// Pairs of triangles that cross when the seams of the open garment at x are joined as they are.
int crossings_when_joined(const DrapeRun& run, const Points& x);

} // namespace toile
