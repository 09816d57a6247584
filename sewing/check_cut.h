// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patterns/pattern.h"

namespace toile {

/// Throws std::invalid_argument for the pattern of a cut surface (pattern_of) that cannot be sewn: a panel that overlaps itself in the plane, by panel
/// and lines; sides of a seam that differ by more than 5 % and 1 mm; whatever else is an error to check().
void expect_sound(const Pattern& pattern);

} // namespace toile
