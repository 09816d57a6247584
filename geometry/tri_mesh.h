// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/types.h"

namespace toile {

/// Any triangulated surface. Triangles are counter-clockwise seen from outside.
struct TriMesh {
    Points points;
    std::vector<Triangle> triangles;
};

/// m2, of a triangle in space.
inline double triangle_area(const Points& p, const Triangle& t) {
    return 0.5 * (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).norm();
}

} // namespace toile
