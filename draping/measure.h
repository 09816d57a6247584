// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// By how much a drape meets its promises. Everything here is computed from the mesh alone, as an independent
// reader of the written file would compute it.

#include "draping/fabric/fabric.h"
#include "sewing/avatar.h"
#include "sewing/garment.h"

namespace toile {

struct Spread {
    double min = 0, max = 0, p99 = 0, mean = 0; ///< area-weighted; p99 of the absolute value
};

/// Strain per triangle of the written mesh: stretch - 1 along warp and weft, principal stretches - 1, and the
/// angle (rad) by which warp and weft have left their right angle.
struct StrainMeasure {
    Spread warp, weft, principal, shear;
    double limit_warp = 0, limit_weft = 0, limit_shear = 0; ///< the tightest of the fabrics used
    double compressed_area = 0; ///< share of the area off eased seams whose smaller principal stretch is below 0.98
};

struct DevelopabilityMeasure {
    double angle_defect_mean = 0, angle_defect_max = 0; ///< rad, |2 pi - sum of angles| at inner nodes off seams and darts
};

/// Ease at a height: girth of the garment minus girth of the body, metres; `found` is false where the garment
/// does not go round the torso.
struct EaseMeasure {
    bool found = false;
    double garment = 0, body = 0, ease = 0;
};

struct IntersectionCount {
    int cloth_avatar = 0, cloth_cloth = 0;
};

/// One fabric per panel.
using PanelFabrics = std::vector<Fabric>;

StrainMeasure measure_strain(const Garment& garment, const Points& x, const PanelFabrics& fabrics);
DevelopabilityMeasure measure_developability(const Garment& garment, const Points& x);
EaseMeasure measure_ease(const Garment& garment, const Points& x, const TriMesh& body, double height);
double seam_gap_max(const Garment& garment, const Points& x);
IntersectionCount count_intersections(const std::vector<Triangle>& cloth, const Points& x, const TriMesh& body);
/// Smallest distance between cloth and body, metres.
double clearance_min(const std::vector<Triangle>& cloth, const Points& x, const TriMesh& body);

} // namespace toile
