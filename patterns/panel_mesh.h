// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patterns/planar_mesh.h"

namespace toile {

/// A straight piece of a sampled border, between two of its points.
struct BorderSegment {
    int a = 0, b = 0;
    int interval = 0;    ///< of the BorderPlan
    bool outline = true; ///< outline or hole; false: inner line
};

/// The sampled border of one panel: what its triangulation must keep as it is.
struct PanelBorder {
    std::vector<Vec2> points;
    std::vector<BorderSegment> segments;
};

/// Two segments that cross or touch other than in a shared point; {-1, -1} when there are none.
std::array<int, 2> crossing_segments(const PanelBorder& border);

/// Triangulates a panel so that the mean edge is `edge` metres, times `size` (in (0, 1]) where that is given.
/// `sweeps` of smoothing. The border's points come first and no segment is split.
PlanarMesh mesh_panel(const PanelBorder& border, double edge, const SizeAt& size, int sweeps);

/// The same with inner points on a lattice of spacing `edge` along warp and weft (`grain` as in Panel), where they stay
/// however they meet the border: most inner edges are then along warp or weft, and the others diagonals.
PlanarMesh mesh_panel_along_grain(const PanelBorder& border, double edge, double grain, int sweeps);

/// Mean over the edges of a mesh of length / wanted length, leaving out what cannot meet it: edges at corners
/// below 60 degrees and at border samples under half or over twice the target. 1 when nothing is left.
double mean_edge_ratio(const PlanarMesh& mesh, double edge, const SizeAt& size);

/// Border points at which no mesh can have good angles or edges: see mean_edge_ratio.
std::vector<bool> awkward_points(const PlanarMesh& mesh, double edge, const SizeAt& size);

} // namespace toile
