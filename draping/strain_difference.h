// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// How far apart the strains of two drapes of one pattern are, on meshes of their own.

#include "sewing/garment.h"

namespace toile {

/// RMS over the cloth's area and over warp and weft of the difference of their strains (a share). Strains of triangles jump from
/// one to the next: what is compared are their means round every vertex (weighted by area), linear between, at the
/// vertices of `b` and at the same places of the same panels of `a`, each of which must have a triangle with area. Cloth gathered into an eased seam counts as not compressed.
double strain_difference(const Garment& a, const Points& x_a, const Garment& b, const Points& x_b);

} // namespace toile
