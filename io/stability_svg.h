// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/stability/map.h"

#include <string>

namespace toile {

/// "springs-explicit: swing".
std::string map_title(const StabilityMap& map);

/// A heat map: what share of the meshes works at every stiffness and value, both logarithmic, and where theory has the boundary of each
/// mesh as a line. What a cell stands for is said where the pointer rests on it.
std::string stability_svg(const StabilityMap& map);

} // namespace toile
