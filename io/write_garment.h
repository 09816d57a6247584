// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sewing/avatar.h"
#include "sewing/garment.h"

#include <string>

namespace toile {

/// Of a written OBJ; GLB is metres and y up by its standard.
struct WriteOptions {
    double metres_per_unit = 1;      ///< 1 m, 0.01 cm, 0.001 mm
    bool z_up = false;               ///< otherwise y up; z up is (x, -z, y)
    const TriMesh* avatar = nullptr; ///< written too, as an object or mesh of its own called "avatar"
};

enum class GarmentFormat { obj, glb };

/// By the file's ending, whatever its case. Throws InputError that lists the endings when it is none of them.
GarmentFormat garment_format(const std::string& path);

/// By the file's ending: .obj (with .mtl beside it) or .glb. Written beside the target and renamed.
/// OBJ carries every double exactly (in metres), GLB the nearest floats.
/// Throws InputError when the target cannot be written.
void write_garment(const std::string& path, const Garment& garment, const Points& x,
                   const WriteOptions& options = {});

/// Every file that write_garment(path) makes.
std::vector<std::string> garment_files(const std::string& path);

/// A mesh as a plain OBJ.
void write_mesh(const std::string& path, const TriMesh& mesh, const WriteOptions& options = {});

/// The positions that a GLB carries: rounded to float.
Points rounded_to_float(const Points& x);

} // namespace toile
