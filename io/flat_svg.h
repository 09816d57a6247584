// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patterns/pattern.h"

#include <string>

namespace toile {

/// The pattern as a picture, SVG in millimetres at full size: panels beside each other as the file draws
/// them, with their names, grain, holes and inner lines; sewn parts of edges in the colour of their seam,
/// numbered in pairs, an arrow in the direction in which each side is walked; edge numbers and labels; darts,
/// elastics, pins; a bar of 10 cm. All coordinates must be finite (see check()).
std::string flat_svg(const Pattern& pattern);

/// Written beside the target and renamed. Throws InputError when the target cannot be written.
void write_flat_svg(const std::string& path, const Pattern& pattern);

} // namespace toile
