// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What this process takes of the machine's memory.

namespace toile {

/// Bytes in physical memory.
struct MemoryUse {
    double now = 0, peak = 0;
};

/// All zero where the system does not tell. Costs some ten microseconds.
MemoryUse memory_use();

} // namespace toile
