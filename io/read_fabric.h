// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A cloth of one's own, in a file: a preset with what differs from it. docs/fabrics.md and docs/fabric.schema.json describe it.

#include "draping/fabric/fabric.h"
#include "io/input_error.h"

#include <iosfwd>

namespace toile {

/// Whether a fabric's name is that of a file: it ends in ".json".
bool is_fabric_file(const std::string& name);
/// That file; empty for the name of a preset.
std::string fabric_file(const std::string& name);

/// Throws InputError: not JSON, unknown keys, numbers out of their range, what is no stretch curve, a membrane that would not be
/// positive definite.
Fabric read_fabric(std::istream& in, const std::string& name);

/// A preset, or what the file says. Throws InputError, or std::invalid_argument when there is no such preset.
Fabric fabric_called(const std::string& name);

} // namespace toile
