// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patterns/pattern.h"

#include <string>

namespace toile {

/// A pattern as a GarmentCode specification (docs/formats.md) in centimetres: outlines, placements, labels and seams. Its seams join
/// whole edges, one to one, the second walked backwards. Throws std::invalid_argument for what a specification cannot say.
std::string pattern_text(const Pattern& pattern);

} // namespace toile
