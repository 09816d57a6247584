// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A panel that is not flat at rest: a moulded cup, a collar that was pressed to shape, a ball without seams.

#include "geometry/tri_mesh.h"

#include <string>

namespace toile {

/// The cloth of a panel as it was moulded. Its own triangles are draped, on every level. Front is the fabric's right side.
struct RestMesh {
    std::string file; ///< what messages call it
    TriMesh mesh;     ///< m, in the coordinates that the panel's placement takes to space
    Points warp;      ///< per triangle, any length: the direction that lies along the warp when laid into its plane
    std::vector<Vec2> flat; ///< per point, m: where pictures of the cut cloth have it
    /// Points of the border along every edge of the panel's outline, from its start to its end. Borders run as the triangles
    /// at them do, the cloth on their left seen from the right side.
    std::vector<std::vector<int>> edges;
};

/// Where the points along an edge lie, as fractions of its length, 0 to 1.
std::vector<double> fractions_along(const RestMesh& rest, int edge);

/// The place at a fraction of an edge's length.
Vec3 place_along(const RestMesh& rest, int edge, double t);

/// m
double length_along(const RestMesh& rest, int edge);

} // namespace toile
