// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A garment mesh, ours or another tool's, that crosses itself or a body, moved by as little as will do until it does
// neither. The mesh is its own rest shape; gravity, fabric and pattern play no part. See docs/untangle.md.

#include "draping/drape.h"

namespace toile {

struct UntangleGarmentOptions {
    double clearance = 0.5e-3; ///< m, to be kept from the body and between cloth where it was crossing; a tenth at least
    double max_seconds = 1e9;  ///< wall time after which the best state reached is returned
    /// Called often; returns false to stop with the best state reached.
    std::function<bool(const DrapeProgress&)> progress;
};

enum class UntangleStatus { clear, tangled, limit };

/// The word of the report: "clear", "tangled", "limit".
const char* to_string(UntangleStatus status);

/// How far a state is from another of the same mesh.
struct Change {
    int moved = 0;                ///< nodes that are not where they were, to the bit
    double largest = 0, mean = 0; ///< m, over all nodes
    Vec3 at = Vec3::Zero();       ///< where the node that moved most was
    /// Change of edge lengths as a share of them, or of a tenth of the mean edge where that is longer.
    double edge_largest = 0, edge_mean = 0;
    Vec3 edge_at = Vec3::Zero();  ///< the middle of that edge, where it is now
};

struct UntangledGarment {
    Points x; ///< by node of the garment
    UntangleStatus status = UntangleStatus::tangled;
    Change change;
    int crossings = 0, inside = 0; ///< pairs of triangles that still cross, nodes that are still in the body
    std::vector<std::string> decisions; ///< what was done, in sentences
};

/// Takes cloth that crosses itself apart, presses the rest out of the body and lets it come to rest under contact. Nodes
/// far from any crossing stay where they are; nodes at exactly one place on borders stay at one place. A garment that
/// crosses nothing comes back as it is. The state returned is the one of fewest crossings on the way, `x` at worst.
/// Coordinates must be finite (std::invalid_argument). `body` may be empty.
UntangledGarment untangle_garment(const Garment& garment, const Points& x, const TriMesh& body,
                                  const UntangleGarmentOptions& options = {});

/// From `before` to `after`, by node of the garment.
Change change_of(const Garment& garment, const Points& before, const Points& after);

} // namespace toile
