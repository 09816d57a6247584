// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// All shapes in which a sheet comes to rest on its own: one that is curved at rest may stay inside out.

#include "draping/fabric/fabric.h"
#include "draping/rest/nearest.h"
#include "sewing/garment.h"

namespace toile {

/// A mesh in space as cloth that is at rest there, of one panel; its points are nodes and vertices. `warp` has a direction per
/// triangle (see edges_in_grain()). Throws std::invalid_argument for a triangle without area, named by its number.
Garment moulded_cloth(const std::vector<Triangle>& triangles, const Points& x, const Points& warp);

struct RestingOptions {
    double tolerance = 1e-6;   ///< force on a node as a share of its weight
    int max_iterations = 1000; ///< of each start
};

struct RestingStates {
    std::vector<FoundShape> found; ///< lowest energy first; `gradient` is a force over a weight, as the tolerance
    int starts = 0, unsettled = 0; ///< starts, and how many of them did not come to rest
};

/// The states of the sheet of `equilibrium` without weight or contact, from the starts of distinct_shapes(). Strain limits
/// do not act: a shell that snaps through passes shapes beyond them.
RestingStates resting_states(const Garment& garment, const Fabric& fabric, const Points& start,
                             const RestingOptions& options = {});

} // namespace toile
