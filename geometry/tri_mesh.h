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

/// A third of the area of every triangle, m2, to each of its corners.
inline std::vector<double> corner_areas(int corners, const std::vector<Triangle>& triangles, const std::vector<double>& areas) {
    std::vector<double> of_corner(corners, 0.0);
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (const int c : triangles[t]) of_corner[c] += areas[t] / 3;
    return of_corner;
}

} // namespace toile
