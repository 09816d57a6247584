// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace toile {

/// Text as it stands in SVG and HTML, also within quotes; what cannot be shown is a question mark.
std::string escaped(const std::string& text);

/// A field of a table of comma-separated values, in quotes where it has to be.
std::string csv_field(const std::string& words);

/// A page of HTML that needs nothing else: `title` as its heading too, then `body`, elements of HTML.
std::string html_page(const std::string& title, const std::string& body);

} // namespace toile
