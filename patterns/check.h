// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patterns/pattern.h"

namespace toile {

enum class Severity { note, warning, error };

/// One thing that is wrong, in a sentence that names panel, edge or seam.
struct Issue {
    Severity severity;
    std::string text;
};

struct SeamLengths {
    double a = 0, b = 0; ///< metres
    double ease = 0;     ///< max(a, b) / min(a, b) - 1
};

struct CheckOptions {
    double max_ease = 1.5;        ///< ratio - 1 above which a seam is an error (2.05 : 1 occurs in real ruffles)
    double warn_ease = 0.1;
    double min_edge = 1e-4;       ///< metres; a shorter edge is degenerate
    double max_extent = 20;       ///< metres; a larger panel has senseless units
    int max_edges = 100000;       ///< in the whole pattern
};

/// Everything wrong with a pattern: open loops, panels that cross themselves, degenerate edges, overlapping seam
/// spans, seams that name nothing, length mismatches, twisted seams, senseless units, NaN and infinity.
std::vector<Issue> check(const Pattern& pattern, const CheckOptions& options = {});

SeamLengths seam_lengths(const Pattern& pattern, const Seam& seam);

} // namespace toile
