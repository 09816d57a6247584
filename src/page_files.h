// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace toile {

/// A page of HTML, its data as CSV and JSON, and its pictures: what the files hold.
struct PageFiles {
    struct Picture {
        std::string name; ///< of what it shows
        std::string svg;
    };
    std::string html, csv, json;
    std::vector<Picture> pictures;
};

/// Writes the page, and beside PAGE.html PAGE.csv, PAGE.json and PAGE-NAME.svg. Returns the files written. Throws InputError.
std::vector<std::string> write_page(const std::string& page, const PageFiles& files);

} // namespace toile
