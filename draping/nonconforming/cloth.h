// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A garment as cloth that keeps its lengths exactly, put together from its parts.

#include "draping/nonconforming/bend.h"
#include "draping/nonconforming/midpoints.h"
#include "draping/nonconforming/rest.h"

namespace toile {

struct NonconformingCloth {
    Midpoints midpoints;
    MidpointBending bending;
    Bars bars;
};

/// Seams should be closed. `fabrics` has one entry per panel. Throws std::invalid_argument for a fabric
/// without weight or whose bending is not positive definite, and for a triangle without area.
NonconformingCloth make_nonconforming_cloth(const Garment& garment, const std::vector<Fabric>& fabrics,
                                            const std::vector<Clamp>& clamps = {});

/// Pulls a ghost node to a place: a pin, or a stitch to what stands still.
struct GhostSpring {
    int node = 0;
    Vec3 place{0, 0, 0};
    double stiffness = 0; ///< N/m
};

/// Bending, gravity (m/s^2), forces on ghost nodes (N; empty: none) and springs; nothing is held.
IsometricProblem problem_of(const NonconformingCloth& cloth, const Vec3& gravity,
                            const Points& ghost_forces = {}, const std::vector<GhostSpring>& springs = {});

} // namespace toile
