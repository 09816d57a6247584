// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/text.h"

#include <cstdarg>
#include <cstdio>

namespace toile {

std::string text(const char* format, ...) {
    std::va_list values, again;
    va_start(values, format);
    va_copy(again, values);
    std::string printed(std::vsnprintf(nullptr, 0, format, values), '\0');
    std::vsnprintf(printed.data(), printed.size() + 1, format, again);
    va_end(again);
    va_end(values);
    return printed;
}

} // namespace toile
