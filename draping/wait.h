// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Seams that wait: what a dressmaker lets hang before its sides can be sewn.

#include "geometry/tri_mesh.h"
#include "sewing/garment.h"

namespace toile {

struct Waiting {
    std::vector<char> seams;   ///< by seam
    std::vector<bool> outside; ///< by panel: lies outside of all that is sewn first
};

/// Seams of an open garment that are wider than `closed` m at x and have the body between their sides wait, and with
/// them those that would join what hangs by nothing but one side to what hangs by another: the sides of a flounce at
/// the end of a skirt. Nothing waits (empty)
/// when no seam is in that state, or every one. What carries is told by labelled borders; without any, seams wait alone.
Waiting what_waits(const Garment& garment, const Points& x, const TriMesh& body, double closed);

} // namespace toile
