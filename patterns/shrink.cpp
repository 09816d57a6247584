// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/shrink.h"

#include "geometry/text.h"
#include "patterns/curve.h"
#include "patterns/plane.h"

#include <cmath>

namespace toile {

namespace {

constexpr int intervals = 64; // of a curve, whose share of its length is found by its chords

double along(const std::vector<Vec2>& line) {
    double sum = 0;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) sum += (line[k + 1] - line[k]).norm();
    return sum;
}

double side_at_rest(const Pattern& pattern, const SeamSide& side) {
    double sum = 0;
    for (const EdgeSpan& span : side) sum += length_at_rest(pattern, span);
    return sum;
}

std::string in_words(double shrink, const char* along) {
    if (shrink == 0) return "";
    return text("%s by %.4g %% along the %s", shrink > 0 ? "shrunk" : "stretched", 100 * std::abs(shrink), along);
}

} // namespace

Mat2 to_rest(const Panel& panel) { return (Vec2::Ones() - panel.shrink).asDiagonal() * to_grain(panel.grain); }

double length_at_rest(const Pattern& pattern, const EdgeSpan& span) {
    const Panel& panel = pattern.panels[span.panel];
    const Edge& edge = panel.outline[span.edge];
    const double cut = std::abs(span.t1 - span.t0) * length(edge);
    if (panel.shrink == Vec2::Zero() || cut == 0) return cut;
    std::vector<Vec2> line = sample(edge, span.t0, span.t1, std::holds_alternative<Straight>(edge.curve) ? 1 : intervals);
    const double chords = along(line);
    for (Vec2& at : line) at = to_rest(panel) * at;
    return cut * along(line) / chords;
}

SeamLengths seam_lengths_at_rest(const Pattern& pattern, const Seam& seam) {
    return lengths_of(side_at_rest(pattern, seam.a), side_at_rest(pattern, seam.b));
}

std::string shrink_in_words(const Panel& panel) {
    const std::string warp = in_words(panel.shrink.y(), "warp"), weft = in_words(panel.shrink.x(), "weft");
    return warp + (warp.empty() || weft.empty() ? "" : " and ") + weft;
}

} // namespace toile
