// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/types.h"

#include <cstdint>
#include <string>

namespace toile {

/// Points and polygons as a mesh file has them, in its unit and axes.
struct Polygons {
    Points points;
    std::vector<std::vector<int>> faces; ///< at least three corners each
};

/// OBJ, PLY, STL, GLB or COLLADA, told by the file's extension. The order of points and faces is the file's (STL, GLB
/// and COLLADA: part by part). Throws InputError: no such file, larger than `max_bytes`, not a mesh, no faces, not
/// finite.
Polygons read_polygons(const std::string& path, std::uintmax_t max_bytes);

} // namespace toile
