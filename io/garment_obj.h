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

/// The same file with some of its points elsewhere: `moved` has places in metres, y up, by the number of the line `v`
/// from 0; `file` says the file's unit and up axis. Normals (`vn`) turn with the faces that use them. Every other line
/// stays as it is, to the byte.
std::string moved_obj(std::string_view text, const std::string& name, const std::map<int, Vec3>& moved,
                      const WriteOptions& file);

/// A direction that turns as what it stands on does.
Vec3 turned_with(const Vec3& direction, const Vec3& facing_was, const Vec3& facing_is);

/// Throws InputError naming the line.
GarmentParts parse_garment_obj(std::string_view text, const std::string& name);

} // namespace toile
