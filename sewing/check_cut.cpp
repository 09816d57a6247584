// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/check_cut.h"

#include "geometry/text.h"
#include "patterns/check.h"
#include "patterns/crossing.h"

#include <cmath>
#include <stdexcept>

namespace toile {

namespace {

constexpr double most_ease = 0.05, least_ease = 1e-3; // share, m

std::string quoted(const std::string& name) { return '"' + name + '"'; }

/// The line that an edge of a panel was cut along, in words.
std::string along(const Pattern& pattern, int panel, int edge) {
    std::string line = pattern.panels[panel].outline[edge].label;
    for (const Seam& seam : pattern.seams)
        for (const EdgeSpan& s : {seam.a[0], seam.b[0]})
            if (s.panel == panel && s.edge == edge) line = seam.name;
    return line.empty() ? "the border of the surface" : "line " + quoted(line);
}

} // namespace

void expect_sound(const Pattern& pattern) {
    for (int p = 0; p < int(pattern.panels.size()); ++p) {
        const Panel& panel = pattern.panels[p];
        const std::vector<LineCrossing> found = find_crossings({Chain{&panel.outline}}, CheckOptions{}.max_extent);
        if (found.empty()) continue;
        const LineCrossing& c = found[0];
        throw std::invalid_argument("panel " + quoted(panel.name) + " overlaps itself when it is laid flat: its edge along " +
                                    along(pattern, p, c.edge_a) + " meets that along " + along(pattern, p, c.edge_b) +
                                    text(" at (%.1f, %.1f) cm; a further line that divides it, or ends in it, was expected", 100 * c.at.x(), 100 * c.at.y()));
    }
    for (const Seam& seam : pattern.seams) {
        const SeamLengths l = seam_lengths(pattern, seam);
        if (!(l.ease > most_ease && std::abs(l.a - l.b) > least_ease)) continue;
        throw std::invalid_argument("a seam along line " + quoted(seam.name) + " joins " + text("%.1f mm", 1e3 * l.a) + " of panel " +
                                    quoted(pattern.panels[seam.a[0].panel].name) + " to " + text("%.1f mm", 1e3 * l.b) + " of panel " +
                                    quoted(pattern.panels[seam.b[0].panel].name) + "; sides that differ by at most 5 % or 1 mm were expected");
    }
    for (const Issue& issue : check(pattern))
        if (issue.severity == Severity::error) throw std::invalid_argument("the pattern could not be draped: " + issue.text);
}

} // namespace toile
