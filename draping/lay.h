// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Panels that lie far from what they are sewn to, laid anew where their seams want them.

#include "geometry/tri_mesh.h"
#include "sewing/garment.h"

namespace toile {

struct LayOptions {
    double gain = 0.15;      ///< m, by which a move must shorten a panel's threads on average to be made
    std::vector<bool> fixed; ///< per panel: must stay; empty: none
};

struct LaidPanel {
    int panel = 0;
    double moved = 0;  ///< m, its middle
    double turned = 0; ///< rad
};

struct Laid {
    Points x; ///< nodes of the garment
    std::vector<LaidPanel> moved; ///< each panel once, ascending
};

/// Moves one panel after another, the one that gains most first, as a rigid piece to where the threads of its
/// open seams are shortest: the shift, and the rotation where it is worth it, that bring its seam points nearest
/// to those they are sewn to (least distances, not squares, so that one misplaced neighbour does not count much),
/// and from there, where the panel's right side looks at the body, straight on through the body until it looks
/// away from it. A thread that passes through the body counts as 30 cm longer, and a right side that looks at the
/// body as a metre. Panels that would gain less than the options ask for stay: fronts and backs that lie before
/// and behind a body do. So do pieces that are not flat, and everything when the right sides of most look at the
/// body, since sides say nothing then. `garment` is open (a node per vertex) or partly closed.
Laid lay_anew(const Garment& garment, const Points& x, const TriMesh& body, const LayOptions& options = {});

} // namespace toile
