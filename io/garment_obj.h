// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Garments as Wavefront OBJ: `v` are nodes, `vt` are the vertices of the cut cloth, groups are panels.
// Described in docs/outputs.md.

#include "io/garment_parts.h"
#include "io/write_garment.h"

#include <string_view>

namespace toile {

std::string garment_obj(const Garment& garment, const Points& x, const WriteOptions& options,
                        const std::string& mtl_name);
std::string garment_mtl(const Garment& garment, const WriteOptions& options);
std::string mesh_obj(const TriMesh& mesh, const WriteOptions& options);

/// The panels' names as OBJ can hold them: without white space, all different, none the avatar's.
std::vector<std::string> group_names(const Garment& garment);

/// Throws InputError naming the line.
GarmentParts parse_garment_obj(std::string_view text, const std::string& name);

} // namespace toile
