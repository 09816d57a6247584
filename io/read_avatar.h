// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sewing/avatar.h"

#include <string>
#include <vector>

namespace toile {

struct ReadAvatarOptions {
    bool repair = false;                      ///< close holes instead of refusing
    std::uintmax_t max_bytes = 1u << 30;      ///< larger files are refused
};

struct ReadAvatar {
    TriMesh body;                    ///< metres, y up, feet as in the file
    std::vector<std::string> notes;  ///< unit and up axis found, quads split, holes closed: for the report
};

/// Any closed triangle or quad mesh in OBJ, PLY, STL, GLB or COLLADA. Throws InputError: not a mesh, no
/// triangles, too large, leaky (with the place of the hole), not finite.
ReadAvatar read_avatar(const std::string& path, const ReadAvatarOptions& options = {});

} // namespace toile
