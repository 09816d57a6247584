// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sewing/avatar.h"
#include "sewing/garment.h"

#include <string>

namespace toile {

struct WriteOptions {
    double metres_per_unit = 1;  ///< of the written file: 1 m, 0.01 cm, 0.001 mm
    bool z_up = false;           ///< otherwise y up
    const TriMesh* avatar = nullptr; ///< written too, as a group or mesh of its own
};

/// By the file's ending: .obj (with .mtl beside it) or .glb. Written beside the target and renamed.
/// Throws InputError when the target cannot be written.
void write_garment(const std::string& path, const Garment& garment, const Points& x, const WriteOptions& options = {});

/// A mesh as a plain OBJ.
void write_mesh(const std::string& path, const TriMesh& mesh, const WriteOptions& options = {});

} // namespace toile
