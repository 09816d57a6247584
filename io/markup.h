// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace toile {

/// Text as it stands in SVG and HTML, also within quotes; what cannot be shown is a question mark.
std::string escaped(const std::string& text);

} // namespace toile
