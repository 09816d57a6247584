// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "io/input_error.h"
#include "patterns/pattern.h"

#include <iosfwd>

namespace toile {

/// GarmentCode specification (2023 form and the 2021 form of Garment-Pattern-Generator), told apart by
/// content. A companion `<stem>.toile.json` beside the file is read with it when it exists (see
/// docs/formats.md). Throws InputError: no file, not JSON, missing or unknown keys, wrong types, numbers that
/// are no length, vertices or panels that do not exist, more than 100,000 edges, more than 64 MB. What is
/// drawn badly rather than written badly (open loops, crossings, lengths) is for check() to say.
Pattern read_pattern(const std::string& path);

/// From a stream; `name` is what messages call it. No companion is looked for.
Pattern read_pattern(std::istream& in, const std::string& name);

} // namespace toile
