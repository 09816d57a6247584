// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// How limits on the elongation of springs are swept over; see limited.h.

#include <string>

namespace toile {

/// What comes first in a sweep has its way least: the springs after it move its ends again.
enum class SweepOrder { listed, reversed, longest_first, from_top };

const char* to_string(SweepOrder order); ///< "listed", "reversed", "longest-first", "from-top"
/// Throws std::invalid_argument with the names when there is no such order.
SweepOrder sweep_order(const std::string& name);

struct LimitOptions {
    bool shear = false; ///< springs of shear too, not only those along warp and weft
    SweepOrder order = SweepOrder::listed;
    int sweeps = 1;     ///< after every substep
};

} // namespace toile
