// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth that steam has made shorter or longer than it was cut: what Panel::shrink says of lengths.

#include "patterns/check.h"

namespace toile {

/// By which share cloth may be shrunk, or stretched.
constexpr double most_shrink = 0.5;

/// Panel coordinates as cut to those of the cloth at rest, (weft, warp). Exact where nothing is shrunk.
Mat2 to_rest(const Panel& panel);

/// m, of a part of an outline in the cloth at rest.
double length_at_rest(const Pattern& pattern, const EdgeSpan& span);

/// Lengths of both sides of a seam in the cloth at rest. The seam's spans must exist.
SeamLengths seam_lengths_at_rest(const Pattern& pattern, const Seam& seam);

/// "shrunk by 3 % along the warp and stretched by 1 % along the weft"; empty where it is neither.
std::string shrink_in_words(const Panel& panel);

} // namespace toile
