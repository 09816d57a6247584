// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A drape that chooses its own meshes until its error is as small as asked.

#include "draping/drape.h"

namespace toile {

inline constexpr double first_accuracy_edge = 0.04; ///< m, of the first mesh: that of the coarsest level of a drape

/// By place of the cloth of a panel at rest, (weft, warp).
using PlaceFactor = std::function<double(int panel, const Vec2& at)>;

struct AccuracyOptions {
    AccuracyOf of = AccuracyOf::place; ///< with a budget it has to be
    double asked = 2e-3;   ///< error against the drape at half the edge length; of no account with a budget
    std::optional<double> budget; ///< s of wall time in which the error is to be made as small as it goes; the result then depends on the machine
    double finest = 2e-3;  ///< m, no mesh is finer
    bool ends_early = true; ///< iterations end when they move the cloth by little of what is asked
    bool leaves_out_self_contact = true; ///< where cones of normals and boxes show that the cloth cannot touch itself
    bool leaves_out_friction = true; ///< where it touches nothing at all
    bool lighter_method = true; ///< Method::projective for cloth that touches nothing, where it makes the last mesh the same
    bool graded = true;    ///< meshes are as fine as their edge length where the cloth is curved, and coarser elsewhere
    /// The pattern at an edge length, m, and a factor in (0, 1] on it by place (empty: 1), at nested levels.
    std::function<Staging(double edge_length, const PlaceFactor& size)> mesh;
};

/// Drapes at a coarse edge length, and on at finer ones, each from where the mesh before came to rest, until the estimate of
/// the error, of place or of strain, is at most `asked`, no finer mesh is allowed, or the limits of `options` end it. The estimate is what two
/// meshes differ by, carried on by the order that three show or that is assumed (draping/accuracy.h), and ten times
/// what the last iteration moved: iterations end when that is below a tenth of what is asked. With a budget finer meshes
/// follow as long as one more is expected to fit, by the vertices and the time of the one before; one that does not is taken back. Result: that of the last mesh with DrapeResult::accuracy; levels and seconds are those of all. A mesh that does
/// not come to rest ends it with its own status.
DrapeResult drape_to_accuracy(const AccuracyOptions& accuracy, const Avatar& avatar, const PanelFabrics& fabrics,
                              const DrapeOptions& options);

} // namespace toile
