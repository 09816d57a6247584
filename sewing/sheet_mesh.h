// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Flat rectangles of cloth without a pattern.

#include "sewing/garment.h"

namespace toile {

enum class MeshKind {
    aligned,      ///< squares, all halved by the same diagonal
    alternating,  ///< squares halved in turn one way and the other
    unstructured, ///< the triangles of a panel
};

struct SheetMesh {
    std::vector<Vec2> points; ///< m
    std::vector<Triangle> triangles; ///< counter-clockwise
};

/// Rectangles of [0, length] x [0, width], `along` by `up` of them, halved as aligned or alternating.
SheetMesh halved_rectangles(MeshKind kind, double length, double width, int along, int up);

/// [0, length] x [0, width], with edges of about `edge` (m).
SheetMesh sheet_mesh(MeshKind kind, double length, double width, double edge);

/// The same with every point inside moved by up to `share` of its shortest edge in each coordinate; different for every `seed`.
SheetMesh jittered(SheetMesh mesh, double share, unsigned seed);

/// A mesh of x >= 0 with its mirror image in x = 0: two arms of a strip that its middle line holds. Their equilibrium is symmetric, so that
/// each leaves the line exactly straight, whatever the element.
SheetMesh with_mirror_image(const SheetMesh& half);

/// The mesh as a garment of one panel, the warp along x.
Garment sheet_garment(const SheetMesh& mesh);

} // namespace toile
