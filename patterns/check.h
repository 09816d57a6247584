// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patterns/pattern.h"

namespace toile {

enum class Severity { note, warning, error };

/// One thing that is wrong, in a sentence that names panel, edge or seam. An error: the pattern cannot be
/// draped.
struct Issue {
    Severity severity;
    std::string text;
};

struct SeamLengths {
    double a = 0, b = 0; ///< metres
    double ease = 0;     ///< max(a, b) / min(a, b) - 1; infinity when one side has no length
};

struct CheckOptions {
    double max_ease = 3;      ///< ratio - 1 above which a seam is an error (2.6 : 1 occurs in real gathers),
    double no_error = 0.01;   ///< m, unless its sides differ by less: generators leave millimetres beside a millimetre
    double warn_ease = 0.5;   ///< above this a warning
    double note_ease = 0.1;   ///< above this a note: gathers are a design, not a fault
    double min_edge = 1e-4;   ///< metres; a shorter edge is degenerate
    double max_extent = 20;   ///< metres; a larger panel has senseless units
    double min_extent = 0.03; ///< metres; a pattern whose largest panel is smaller has senseless units
    double max_translation = 100; ///< metres; a panel that starts farther away has senseless units
    double twist = 0.9;     ///< a seam is called twisted when the other direction is below this share as long
    int max_edges = 100000; ///< in the whole pattern
    int max_issues = 100;   ///< further ones are counted, not listed
};

/// Everything wrong with a pattern: open loops, panels that cross or touch themselves (both edges named),
/// degenerate edges, holes outside their panel, overlapping seam spans, seams that name nothing or join an
/// edge to itself, length mismatches, twisted seams, senseless units, too many edges, NaN and infinity. In
/// the order of panels, then seams; the same for the same pattern always.
std::vector<Issue> check(const Pattern& pattern, const CheckOptions& options = {});

/// True when one of the issues is an error.
bool has_error(const std::vector<Issue>& issues);

/// The ease of two such sides.
SeamLengths lengths_of(double a, double b);

/// Lengths of both sides as they are cut. The seam's spans must exist.
SeamLengths seam_lengths(const Pattern& pattern, const Seam& seam);

/// Mean distance between the two sides where the panels start out, sample by sample: as the seam says, and
/// with side b walked the other way. The seam's spans must exist.
struct SeamSpan {
    double chosen = 0, other = 0; ///< metres
};
SeamSpan seam_span_at_start(const Pattern& pattern, const Seam& seam);

} // namespace toile
