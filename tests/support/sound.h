// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/decisions.h"
#include "draping/inspect.h"
#include "io/read_garment.h"

#include <catch2/catch.hpp>

namespace toile::test {

/// What every written garment must be, by a look at the file alone.
inline void check_sound(const ReadGarment& g, const TriMesh& body, const PanelFabrics& fabrics, double compressed,
                        double outside = 0.97) {
    const Inspection i = inspect(g.garment, g.x, body, fabrics);
    CHECK(i.intersections.cloth_avatar == 0);
    CHECK(i.intersections.cloth_cloth == 0);
    CHECK(i.pieces == 1);
    CHECK(i.seam_gap_max == 0);
    CHECK(i.turned_edges == 0);
    CHECK(i.crowded_edges == 0);
    CHECK(i.clearance > 1e-5);
    CHECK(i.strain.warp.max <= i.strain.limit_warp);
    CHECK(i.strain.weft.max <= i.strain.limit_weft);
    CHECK(i.strain.compressed_area < compressed);
    CHECK(right_side_out(g.garment, g.x, body) > outside);
}

} // namespace toile::test
