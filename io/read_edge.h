// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Edges as GarmentCode writes them, which its specifications and the companion file share.

#include "io/json.h"
#include "patterns/pattern.h"

namespace toile {

struct EdgeConventions {
    double metres = 0.01;          ///< per unit of the file
    bool absolute_control = false; ///< control points are panel coordinates, not relative to their edge
};

/// The member "units_in_meter" as metres per unit. Throws InputError.
double read_unit(const JsonView& properties);

/// A number of the file in metres. Throws InputError when it is none or beyond 1e6 m.
double read_length(const JsonView& v, double metres);

/// [x, y]. Throws InputError.
Vec2 read_point(const JsonView& v, double metres);

/// [[x, y], ...], at least two. Throws InputError.
std::vector<Vec2> read_vertices(const JsonView& v, double metres);

/// {"endpoints": [i, j], "curvature": ..., "label": ...}. Throws InputError.
Edge read_edge(const JsonView& v, const std::vector<Vec2>& vertices, const EdgeConventions& as);

} // namespace toile
