// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/memory.h"

#include <cstdio>

namespace toile {

// getrusage() would count the process that started this one as well.
MemoryUse memory_use() {
    MemoryUse use;
    std::FILE* file = std::fopen("/proc/self/status", "r");
    if (!file) return use;
    char line[128];
    double kilobytes = 0;
    while (std::fgets(line, sizeof line, file)) {
        if (line[0] != 'V') continue; // most lines are about something else, and reading formats takes time
        if (std::sscanf(line, "VmHWM: %lf", &kilobytes) == 1) use.peak = 1024 * kilobytes;
        if (std::sscanf(line, "VmRSS: %lf", &kilobytes) == 1) use.now = 1024 * kilobytes;
    }
    std::fclose(file);
    return use;
}

} // namespace toile
