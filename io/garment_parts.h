// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What the garment formats read, before edges and rest shape are worked out.

#include "io/read_garment.h"

#include <map>
#include <optional>

namespace toile {

struct GarmentParts {
    /// A corner of a triangle: node, and index into `uv` (-1: the file gives none).
    struct Corner {
        int node = 0, uv = -1;
    };
    struct Face {
        std::array<Corner, 3> corners;
        int panel = 0;
    };
    Points nodes;
    std::vector<Vec2> uv; ///< as in the file, v upward
    std::vector<Face> faces;
    std::vector<std::string> panel_names;
    std::vector<Stitch> stitches;
    TriMesh avatar;
    std::optional<double> uv_metres;       ///< metres per unit of uv; nothing: the file does not say
    std::map<std::string, Vec2> uv_origin; ///< metres, by panel
    double metres_per_unit = 1; ///< of the file, and whether it says so
    bool unit_given = false;
    bool z_up = false;          ///< in the file
    std::vector<std::string> notes;
};

/// Throws InputError, prefixed by `name`, when there are no triangles or an index or number is unusable.
ReadGarment assemble(GarmentParts parts, const std::string& name);

/// Index of the panel of that name, added at the end when it is new.
int panel_index(GarmentParts& parts, const std::string& panel);

} // namespace toile
