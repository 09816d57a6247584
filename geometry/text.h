// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace toile {

/// What printf would print, of any length. The compiler checks the values against the format. Decimal points
/// are points as long as nobody sets a locale.
[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...);

} // namespace toile
