// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/types.h"

namespace toile {

/// Any triangulated surface. Triangles are counter-clockwise seen from outside.
struct TriMesh {
    Points points;
    std::vector<Triangle> triangles;
};

} // namespace toile
