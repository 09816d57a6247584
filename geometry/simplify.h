// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/tri_mesh.h"

namespace toile {

/// The surface with so few triangles that their mean edge is about `edge_length` (m, positive), fewest where it is flat,
/// unless that would move it by more than `error` (m). Points are a part of the mesh's, in their order; an open border
/// stays. Edges are collapsed in the order of the error that this makes (Garland and Heckbert, Surface Simplification
/// Using Quadric Error Metrics, 1997).
TriMesh simplified(const TriMesh& mesh, double edge_length, double error);

} // namespace toile
