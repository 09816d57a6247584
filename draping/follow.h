// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A dressed garment that follows its body from frame to frame of a motion, by statics: every frame is brought to rest,
// and on the way to it nothing is crossed.

#include "draping/drape.h"

namespace toile {

enum class FrameStatus { converged, stalled, limit, blocked };

/// The word of the report: "converged", "stalled", "limit", "blocked".
const char* to_string(FrameStatus status);

struct FrameReport {
    FrameStatus status = FrameStatus::stalled;
    std::string where;   ///< what blocked, and its place on the garment; empty when converged
    double residual = 0; ///< as in DrapeResult; infinity when nothing was settled
    double behind = 0;   ///< m, of the farthest body point from its place in the frame: 0 but for a blocked one
    IntersectionCount intersections; ///< by exact predicates, with the frame's own body
    int substeps = 0;    ///< motions of the body on the way
    int iterations = 0;  ///< Newton iterations
    double seconds = 0;
};

struct FollowOptions {
    int max_iterations = 500; ///< Newton iterations of a frame once its body is there; at least 1
    int max_substeps = 400;   ///< motions of the body per frame; at least 1
    /// Called with every frame that is done: its place in `frames` and the garment's nodes.
    std::function<void(int frame, const Points& x)> done;
};

/// Whether follow() can start from a drape: its seams are closed and nothing crosses.
bool can_follow(const DrapeResult& dressed, const TriMesh& body);

/// From a drape on `body`, lets the body go to the point positions of each frame in turn. `options` are those of the
/// drape; its `max_seconds` count for all frames together, its `max_iterations` do not. What rests on the body is taken
/// along and stays tied by friction to the place of its surface that it rests on; pins stay in space and hooks keep
/// their height. Body points with cloth in their way wait until it has moved; when they do not get to their place, the
/// frame is blocked and the next one is taken up from where the body is.
/// One report per frame; fewer when a limit or options.progress ends the work, the last one then with status limit.
/// Throws std::invalid_argument when can_follow() does not hold or a frame has another number of points than the body.
std::vector<FrameReport> follow(const Staging& staging, const DrapeResult& dressed, const TriMesh& body,
                                const std::vector<Points>& frames, const PanelFabrics& fabrics,
                                const DrapeOptions& options, const FollowOptions& how);

} // namespace toile
