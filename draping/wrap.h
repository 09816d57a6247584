// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Full skirts laid round the body in pleats, where their files lay them flat before and behind it.

#include "geometry/tri_mesh.h"
#include "sewing/garment.h"

#include <optional>

namespace toile {

/// Lays panels round what they hang from, the seams between them closed, on a cone about a vertical axis, in pleats where
/// they are wider than it: a harmonic azimuth over the cloth, which goes on across seams and gains a turn on the way round, and the
/// distance along the cloth at right angles to it, give every point its place. `x` are the nodes of an open garment, of which the panels that are
/// not `round` (by panel) stay; the flattest and narrowest cone is taken that is clear of the body, of these panels and of the threads between
/// them. Nothing when the panels do not go round, when nothing is above them, or when no cone is clear.
std::optional<Points> wrap_round(const Garment& garment, const Points& x, const TriMesh& body, const std::vector<bool>& round);

} // namespace toile
