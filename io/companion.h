// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What a GarmentCode specification cannot say: fabric, grain, layers, pins, elastics, holes, inner lines and
// seams between parts of edges, in a file beside it. docs/formats.md and docs/companion.schema.json describe
// it.

#include "io/input_error.h"
#include "patterns/pattern.h"

#include <iosfwd>

namespace toile {

/// "shirt_specification.json" has the companion "shirt_specification.toile.json".
std::string companion_path(const std::string& pattern_path);

/// Adds to the pattern what its companion says; files of fabrics are looked for in its folder. Throws InputError: not JSON, unknown keys, panels, edges or
/// labels that the pattern does not have, numbers out of their range.
void read_companion(const std::string& path, Pattern& pattern);
void read_companion(std::istream& in, const std::string& name, Pattern& pattern);

} // namespace toile
