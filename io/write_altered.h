// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// An altered pattern, to be cut: in the file's own form, and as a picture.

#include "patterns/pattern.h"

#include <string>
#include <vector>

namespace toile {

/// The pattern file at `path` with the outlines of `altered`, all else as it was. `drawn` is what read_pattern() read from
/// it. Throws InputError when the file is not that any more.
std::string altered_pattern_text(const std::string& path, const Pattern& drawn, const Pattern& altered);

/// The companion file at `path`, which need not exist, with the elastics and shrunk panels of `altered`, all else as it was.
/// Elastics that are no item of the file are added.
std::string altered_companion_text(const std::string& path, const Pattern& drawn, const Pattern& altered);

/// Both outlines of every panel that differs, the old one dashed, SVG in millimetres at full size; elastics are dotted, and what they
/// and steam change is written below.
std::string altered_svg(const Pattern& drawn, const Pattern& altered);

/// By how much an edge has changed, m.
struct EdgeChange {
    int panel = 0, edge = 0;
    double before = 0, after = 0; ///< m, its length
    double moved = 0;             ///< m, the most that a point of it has moved
};
/// The relaxed length of an elastic, m.
struct ElasticChange {
    int elastic = 0;
    double before = 0, after = 0;
};
/// Of those that have changed by more than a micrometre.
std::vector<ElasticChange> elastic_changes(const Pattern& drawn, const Pattern& altered);

/// Of the edges that have moved by more than a micrometre.
std::vector<EdgeChange> edge_changes(const Pattern& drawn, const Pattern& altered);

} // namespace toile
