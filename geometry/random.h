// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <random>

namespace toile {

/// The next number in [-1, 1). Made of raw bits: those are the same in all libraries, their distributions are not.
inline double next_signed(std::mt19937_64& random) { return 2 * double(random() >> 11) * 0x1p-53 - 1; }

} // namespace toile
