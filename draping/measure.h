// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// By how much a drape meets its promises. Everything here is computed from the mesh alone, as an independent
// reader of the written file would compute it. Positions `x` are by node, in metres; y is up.

#include "draping/fabric/fabric.h"
#include "sewing/avatar.h"
#include "sewing/garment.h"

namespace toile {

/// Weighted by flat area; p99 is that of the absolute value: 99 % of the area stays below it. All zero over
/// nothing.
struct Spread {
    double min = 0, max = 0, p99 = 0, mean = 0;
};

/// Strain per triangle of the written mesh: stretch - 1 along warp and weft, principal stretches - 1 (both of
/// each triangle), and the angle (rad) by which warp and weft have left their right angle (positive: they
/// have closed). Cloth gathered into an eased seam is not strained: there, compression counts as 0.
struct StrainMeasure {
    Spread warp, weft, principal, shear;
    /// The tightest of the fabrics used; 0 when none has one.
    double limit_warp = 0, limit_weft = 0, limit_shear = 0;
    /// Share of the area off eased seams that is compressed: warp or weft shorter than 98 %. Shear is another
    /// thing, which woven cloth does without shortening a yarn.
    double compressed_area = 0;
    /// Share of that area whose smaller principal stretch is below 98 %: by compression or by a shear of more than 2.3 degrees.
    double narrowed_area = 0;
};

/// Largest and mean |2 pi - sum of angles| (rad) over inner nodes off seams and darts.
struct DevelopabilityMeasure {
    double angle_defect_mean = 0, angle_defect_max = 0;
};

/// Ease at a height: girth of the garment minus girth of the body, metres, both by tape measure (convex
/// hull); `found` is false where the garment does not go round the torso. Where several layers do, the
/// tightest counts.
struct EaseMeasure {
    bool found = false;
    double garment = 0, body = 0, ease = 0;
};

struct IntersectionCount {
    int cloth_avatar = 0, cloth_cloth = 0; ///< pairs of triangles
};

/// One fabric per panel.
using PanelFabrics = std::vector<Fabric>;

/// `fabrics` may be empty: the limits are then unknown (0). Triangles of no flat area do not count.
StrainMeasure measure_strain(const Garment& garment, const Points& x, const PanelFabrics& fabrics);

/// The strain of every triangle along (weft, warp), as above; 0 where there is no flat area.
std::vector<Vec2> yarn_strains(const Garment& garment, const Points& x);

DevelopabilityMeasure measure_developability(const Garment& garment, const Points& x);

/// The torso is the largest loop of the body at this height, so it has to be above the crotch.
EaseMeasure measure_ease(const Garment& garment, const Points& x, const TriMesh& body, double height);

/// Longest stitch, metres; 0 when every seam is closed.
double seam_gap_max(const Garment& garment, const Points& x);

/// Pairs of triangles that intersect, by exact predicates, sorted; `cloth` is over nodes. Triangles that one of the
/// `stitches` joins by a node of the one and the inside of an edge of the other (0 < r < 1) lie on each other there, and
/// do not count, as triangles that share a node do not.
struct IntersectingPairs {
    std::vector<std::array<int, 2>> cloth_avatar, cloth_cloth;
};
IntersectingPairs find_intersections(const std::vector<Triangle>& cloth, const Points& x, const TriMesh& body,
                                     const std::vector<Stitch>& stitches = {});

/// How many these are.
IntersectionCount count_intersections(const std::vector<Triangle>& cloth, const Points& x, const TriMesh& body,
                                      const std::vector<Stitch>& stitches = {});

/// Connected pieces of the cloth; stitches to the inside of an edge connect as shared nodes do.
int count_pieces(const Garment& garment);

/// Smallest distance between cloth and body, metres; 0 when they intersect, infinity when either is empty.
double clearance_min(const std::vector<Triangle>& cloth, const Points& x, const TriMesh& body);

} // namespace toile
