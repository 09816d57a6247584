// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patterns/pattern.h"

#include <iosfwd>
#include <stdexcept>

namespace toile {

/// Input that is refused; what() is one sentence that says what is wrong, where, and what was expected.
struct InputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// GarmentCode specification (2023 form and the 2021 form of Garment-Pattern-Generator), told apart by content.
/// A companion `<stem>.toile.json` beside the file is read with it when it exists (see docs/formats.md).
Pattern read_pattern(const std::string& path);
Pattern read_pattern(std::istream& in, const std::string& name);

} // namespace toile
