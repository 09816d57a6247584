// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstring>

namespace toile {

/// Whether `test` is among the words of a command line, or there are none.
inline bool asked(int count, char** words, const char* test) {
    for (int i = 1; i < count; ++i)
        if (std::strcmp(words[i], test) == 0) return true;
    return count == 1;
}

} // namespace toile
