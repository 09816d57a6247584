// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/types.h"

namespace toile {

/// Where every node is: what a solver starts from, ends with and can save.
struct State {
    Points positions;
    Points velocities; ///< empty for statics
    double time = 0;   ///< s
};

} // namespace toile
