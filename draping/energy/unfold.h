// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The rest shape around a triangle, laid flat: neighbours turned over their shared edges into its plane.

#include "sewing/garment.h"

namespace toile {

/// A node and where it lies in the plane of the triangle that the unfolding began with: (weft, warp), metres.
struct RestPoint {
    int node = 0;
    Vec2 at{0, 0};
};

struct Unfolding {
    struct Placed {
        int triangle = 0;
        std::array<RestPoint, 3> corners;
    };
    std::vector<Placed> triangles;
    std::vector<RestPoint>
        points;           ///< every node once, where it was met first; the first triangle's corners first
    std::size_t ring = 0; ///< triangles from here on are the outermost ring
};

/// Triangle t alone, its first corner at the origin.
Unfolding start_unfolding(const Garment& garment, int t);

/// The triangle that shares the edge opposite corner k of t; -1 at a border (an edge with one triangle, or
/// with more than two) and at a crease, across which cloth is not smooth.
int neighbour(const Garment& garment, int t, int k);

/// Adds the neighbour of placed triangle i over the edge opposite corner k, if there is one and it is not
/// placed.
void unfold_over(const Garment& garment, Unfolding& unfolding, int i, int k);

/// Adds all neighbours of the outermost ring; they become the outermost ring.
void unfold_ring(const Garment& garment, Unfolding& unfolding);

} // namespace toile
