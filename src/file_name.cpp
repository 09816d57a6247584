// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/file_name.h"

#include <cctype>

namespace toile {

std::string file_name(const std::string& name) {
    std::string plain;
    for (const char c : name)
        if (std::isalnum(static_cast<unsigned char>(c)))
            plain += c;
        else if (!plain.empty() && plain.back() != '-')
            plain += '-';
    return plain;
}

} // namespace toile
