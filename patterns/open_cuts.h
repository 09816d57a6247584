// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patterns/planar_mesh.h"

namespace toile {

/// Opens the mesh along directed fixed edges: their points get a copy for every piece of cloth that the cuts
/// separate there; a cut's free end stays one point. The left side keeps the points, copies are appended.
/// Returns for every point the one that it copies, or itself.
std::vector<int> open_cuts(PlanarMesh& mesh, const std::vector<std::array<int, 2>>& cuts);

} // namespace toile
