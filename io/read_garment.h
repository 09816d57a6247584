// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/tri_mesh.h"
#include "io/read_pattern.h"
#include "sewing/garment.h"

#include <string>
#include <vector>

namespace toile {

/// A garment mesh as it lies in space: ours or another tool's.
struct ReadGarment {
    Garment garment;   ///< vertices, nodes and triangles in the file's order; stitches where seams are open
    Points x;          ///< node positions, metres, y up
    bool flat = false; ///< the file has texture coordinates, and garment.uv and garment.rest hold the
                       ///< pattern; else zero
    std::vector<int> file_node; ///< by node: its number among the file's (OBJ: among the lines `v`, from 0)
    double metres_per_unit = 1; ///< of the file
    bool z_up = false;          ///< in the file
    TriMesh avatar;    ///< the file's object "avatar"; empty when there is none
    std::vector<std::string> notes; ///< what was assumed, in sentences
};

/// Reads .obj (also staged meshes: `stitch a b c r` from node a to the point (1-r)b + rc counted from 0, or
/// `l a b`) and .glb. A file without the line `# uv_metres S` has `vt` in metres, or scaled to the area in
/// space when its area says otherwise (noted). An OBJ without the line `# metres_per_unit` is in metres, or when it is
/// larger than 10 units in centimetres, larger than 1000 in millimetres (noted). Throws InputError: not such a file, an index out of range, not
/// finite, no triangles.
ReadGarment read_garment(const std::string& path);

} // namespace toile
