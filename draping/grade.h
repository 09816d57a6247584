// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Edge lengths per panel and place from how a drape is curved.

#include "draping/flat_places.h"

#include <functional>

namespace toile {

struct GradeOptions {
    double edge_length = 0.02; ///< m, where the cloth is curved most
    double most = 0.04;        ///< m, where it is flat
    double curved = 0.5;       ///< share of the cloth's area that counts as curved most, [0, 1]
};

/// The curvature of the drape at every node, 1/m: the root of the mean over the area round it of the squared curvature across its
/// edges, from rest on. Seams and folds count as what the cloth does there.
std::vector<double> node_curvature(const Garment& garment, const Points& x);

/// The edge length wanted at every node, m: as the chord of a curve strays from it by h^2 k / 8, it goes with the root of the
/// curvature, from options.edge_length at the curvature that the share `curved` of the area exceeds, up to options.most. A step from
/// one node to the next changes it by no more than half of the way between them, or the mesh could not follow.
std::vector<double> graded_edges(const Garment& garment, const Points& x, const GradeOptions& options);

/// Values at the nodes of a garment, by panel and place; beyond a panel's border those of the nearest triangle. The garment must
/// outlive it, and every panel asked for must have a triangle with area.
std::function<double(int panel, const Vec2& at)> over_panels(const Garment& garment, std::vector<double> of_node);

} // namespace toile
