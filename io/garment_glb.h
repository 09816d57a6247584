// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Garments as binary glTF 2.0 (Khronos, 2017): one mesh per panel. Described in docs/outputs.md.

#include "io/garment_parts.h"
#include "io/write_garment.h"

#include <string_view>

namespace toile {

/// Always metres and y up, as glTF demands; the unit and up axis of `options` do not apply.
std::string garment_glb(const Garment& garment, const Points& x, const WriteOptions& options);

GarmentParts parse_garment_glb(std::string_view bytes, const std::string& name);

} // namespace toile
