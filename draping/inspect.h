// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What can be said of any garment mesh, ours or another tool's, from the mesh alone. Crossings and what lies in the body
// are told by exact predicates (CGAL), with no code shared with the solver's contact.

#include "draping/measure.h"

namespace toile {

/// One place at which cloth passes through the body or through itself: pairs of triangles that hang together, each
/// with another in which both triangles are the same or neighbours.
struct Crossing {
    bool with_body = false;
    std::vector<std::array<int, 2>> pairs; ///< triangle of the garment, and of the body or of the garment; sorted
    Vec3 at = Vec3::Zero();  ///< m, in the boxes of both triangles of the pair that is nearest to the middle of all
    std::vector<int> panels; ///< of the garment's triangles, sorted
};

/// Cloth in the body, by winding numbers: whatever the body crosses of itself, and at any depth.
struct InsideBody {
    bool known = false; ///< false: the body has holes, or is not there
    int nodes = 0;
    double depth = 0;   ///< m, of the deepest node: its distance to the body's surface
    Vec3 at = Vec3::Zero(); ///< that node
    int panel = -1;         ///< and its panel
};

/// Stitches of a seam that is not closed, one run of them.
struct SeamGap {
    std::array<int, 2> panels{}; ///< of its two sides
    int stitches = 0, open = 0;  ///< in all, and those with a gap
    double gap = 0;              ///< m, the widest
    Vec3 at = Vec3::Zero();      ///< the middle of that gap
};

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
    std::vector<SeamGap> gaps; ///< of seams that are not closed, the widest first
    IntersectionCount intersections;
    std::vector<Crossing> crossings; ///< with the body first, then those of most pairs

    bool has_body = false;
    double clearance = 0; ///< m; 0 when the cloth cuts the body; only with a body
    InsideBody inside;

    bool has_pattern = false; ///< the garment knows its flat shape
    StrainMeasure strain;     ///< only with a pattern; the limits are those of `fabrics`
    DevelopabilityMeasure developability;
};

/// `x` by node; `body` may be empty; `fabrics` one per panel, or none. Formats that split nodes along seams
/// (GLB) are understood: nodes on borders that lie at exactly one place count as one.
Inspection inspect(const Garment& garment, const Points& x, const TriMesh& body,
                   const PanelFabrics& fabrics = {});

} // namespace toile
