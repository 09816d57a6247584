// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "io/input_error.h"
#include "sewing/avatar.h"

#include <cstdint>
#include <string>
#include <vector>

namespace toile {

struct ReadAvatarOptions {
    bool repair = false;                 ///< close holes instead of refusing
    std::uintmax_t max_bytes = 1u << 30; ///< larger files are refused
};

/// What a file's coordinates are.
struct AvatarAxes {
    double metres_per_unit = 1;
    bool z_up = false; ///< otherwise y up
};

Vec3 in_metres(const Vec3& p, const AvatarAxes& axes); ///< and y up

struct ReadAvatar {
    TriMesh body;                   ///< metres, y up, feet as in the file; closed, outside by the right-hand rule
    AvatarAxes axes;                ///< of the file
    std::vector<std::string> notes; ///< unit and up axis found, holes closed, ...: for the report
};

/// Any closed mesh of triangles or polygons in OBJ, PLY, STL, GLB or COLLADA (told by the file's extension). The
/// order of points is the file's (OBJ: exactly, less points that no face names). The unit (m, dm, cm, mm) and
/// the up axis (y or z) are told by size: a standing person is 0.4 to 4 m tall and taller than deep. A body may
/// cross itself (armpits, fingers) and consist of several closed pieces.
/// Throws InputError: no such file, too large, not a mesh, no triangles, not finite, leaky (with the place of the
/// hole), without volume, no unit fits.
ReadAvatar read_avatar(const std::string& path, const ReadAvatarOptions& options = {});

} // namespace toile
