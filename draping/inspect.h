// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What can be said of any garment mesh, ours or another tool's, from the mesh alone.

#include "draping/measure.h"

namespace toile {

struct Inspection {
    int panels = 0, vertices = 0, nodes = 0, triangles = 0;
    int not_finite = 0; ///< nodes whose coordinates are no numbers; if there are any, nothing below is known
    int joined_nodes = 0; ///< border nodes at exactly one place, which were taken as one from here on
    int pieces = 0;       ///< connected pieces
    int border_loops = 0;
    int crowded_edges = 0;   ///< edges of more than two triangles
    int turned_edges = 0;    ///< edges whose two triangles face opposite ways
    int flat_triangles = 0;  ///< triangles of no area in space
    double area = 0;         ///< m2, in space
    double mean_edge = 0;    ///< m, in space
    double seam_gap_max = 0; ///< m, longest open stitch
    IntersectionCount intersections;

    bool has_body = false;
    double clearance = 0; ///< m; 0 when the cloth cuts the body; only with a body

    bool has_pattern = false; ///< the garment knows its flat shape
    StrainMeasure strain;     ///< only with a pattern; the limits are those of `fabrics`
    DevelopabilityMeasure developability;
};

/// `x` by node; `body` may be empty; `fabrics` one per panel, or none. Formats that split nodes along seams
/// (GLB) are understood: nodes on borders that lie at exactly one place count as one.
Inspection inspect(const Garment& garment, const Points& x, const TriMesh& body,
                   const PanelFabrics& fabrics = {});

} // namespace toile
