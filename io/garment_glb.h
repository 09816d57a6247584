// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Garments as binary glTF 2.0 (Khronos, 2017): one mesh per panel. Described in docs/outputs.md.

#include "io/garment_parts.h"
#include "io/write_garment.h"

#include <string_view>

namespace toile {

/// Always metres and y up, as glTF demands; the unit and up axis of `options` do not apply.
std::string garment_glb(const Garment& garment, const Points& x, const WriteOptions& options);

/// The same file with some of its nodes elsewhere: `moved` has places in the scene by node as parse_garment_glb() numbers
/// them. Normals turn with the faces at them; all else stays. Throws InputError when positions are not floats, or a mesh
/// hangs in the scene twice.
std::string moved_glb(std::string_view bytes, const std::string& name, const std::map<int, Vec3>& moved);

GarmentParts parse_garment_glb(std::string_view bytes, const std::string& name);

} // namespace toile
