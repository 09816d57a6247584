// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>

namespace toile {

/// Input that is refused; what() is one sentence that says what is wrong, where, and what was expected.
struct InputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

} // namespace toile
