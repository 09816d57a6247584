// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A garment that another tool has cut, meshed and placed: it drapes without being meshed again.

#include "geometry/tri_mesh.h"
#include "io/input_error.h"
#include "sewing/garment.h"

#include <string>
#include <vector>

namespace toile {

struct StagedMesh {
    Garment garment;  ///< panels are the connected pieces of the flat mesh; no fabrics, layer 0, warp along v
    Points positions; ///< of the nodes where they start out, metres, y up
    std::vector<std::string> notes; ///< what was assumed, in sentences
};

struct ReadStagedOptions {
    /// The body the garment is to dress, metres, y up: tells whether the file has y or z up, by which the
    /// cloth lies nearer to it. Without a body y is up, unless the file says `# up z`.
    const TriMesh* body = nullptr;
    std::uintmax_t max_bytes = 1u << 30; ///< larger files are refused
};

/// Reads an OBJ with `v` in space and `vt` flat, in metres (or times the line `# uv_metres S`), v along the
/// warp. Stitches are the lines `l a b` (nodes counted from 1) and `stitch a b c r` (counted from 0): from
/// node a to the point (1 - r) b + r c. A stitch of a node to itself is left out. The unit of `v` (m, dm, cm,
/// mm) is told by comparing it with `vt`. Several `vt` at one `v` are a closed seam. Throws InputError: no
/// such file, no triangles, triangles without vt or without area, a piece that is folded over in the flat,
/// indices out of range, r outside [0, 1], lengths in space and flat that fit no unit.
StagedMesh read_staged(const std::string& path, const ReadStagedOptions& options = {});

} // namespace toile
