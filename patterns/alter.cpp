// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/alter.h"

#include "patterns/curve.h"
#include "patterns/plane.h"
#include "patterns/shrink.h"

#include <cmath>
#include <stdexcept>

namespace toile {

namespace {

using Outlines = std::vector<Loop>;

Vec2 turned_left(const Vec2& v) { return {-v.y(), v.x()}; }

/// Where `at` goes when the chord `from` becomes `to`, and all else turns and grows with it.
Vec2 along_with(const Vec2& at, const Edge& from, const Edge& to) {
    const Vec2 chord = from.end - from.start, off = at - from.start, now = to.end - to.start;
    if (chord.squaredNorm() == 0) return at + to.start - from.start;
    return to.start + (off.dot(chord) * now + cross(chord, off) * turned_left(now)) / chord.squaredNorm();
}

void carry_curve(const Edge& from, Edge& to) {
    if (to.start == from.start && to.end == from.end) return;
    if (auto* q = std::get_if<Quadratic>(&to.curve)) q->control = along_with(q->control, from, to);
    if (auto* c = std::get_if<Cubic>(&to.curve)) {
        c->control0 = along_with(c->control0, from, to);
        c->control1 = along_with(c->control1, from, to);
    }
    const double before = (from.end - from.start).norm();
    if (auto* a = std::get_if<Arc>(&to.curve); a && before > 0) a->radius *= (to.end - to.start).norm() / before;
}

/// The control point of an edge; null when it has none of that number.
Vec2* control_of(Edge& edge, int number) {
    if (auto* q = std::get_if<Quadratic>(&edge.curve); q && number == 1) return &q->control;
    if (auto* c = std::get_if<Cubic>(&edge.curve)) return number == 1 ? &c->control0 : number == 2 ? &c->control1 : nullptr;
    return nullptr;
}

std::string called(const Pattern& pattern, int panel, int edge) {
    return "edge " + std::to_string(edge) + " of panel " + pattern.panels[panel].name;
}

const Edge& edge_of(const Pattern& pattern, int panel, int edge) {
    if (panel < 0 || panel >= int(pattern.panels.size()))
        throw std::invalid_argument("there is no panel " + std::to_string(panel));
    const Loop& outline = pattern.panels[panel].outline;
    if (edge < 0 || edge >= int(outline.size())) throw std::invalid_argument("there is no " + called(pattern, panel, edge));
    return outline[edge];
}

Vec2 direction_of(const Pattern& pattern, int panel, int edge) {
    const Edge& e = edge_of(pattern, panel, edge);
    const double length = (e.end - e.start).norm();
    if (!(length > 0)) throw std::invalid_argument(called(pattern, panel, edge) + " ends where it starts");
    return (e.end - e.start) / length;
}

/// What does not move an outline.
void alter_lengths(const Alteration& a, double amount, Pattern& pattern) {
    for (const ElasticMove& m : a.elastics) {
        if (m.elastic < 0 || m.elastic >= int(pattern.elastics.size()))
            throw std::invalid_argument("there is no elastic " + std::to_string(m.elastic));
        pattern.elastics[m.elastic].ratio += amount * m.ratio;
    }
    for (const ShrinkMove& m : a.shrinks) {
        if (m.panel < 0 || m.panel >= int(pattern.panels.size()))
            throw std::invalid_argument("there is no panel " + std::to_string(m.panel));
        pattern.panels[m.panel].shrink += amount * m.share;
    }
    for (const EaseMove& m : a.eases)
        if (m.seam < 0 || m.seam >= int(pattern.seams.size())) throw std::invalid_argument("there is no seam " + std::to_string(m.seam));
}

/// What rounding alone takes beyond an end of its range is at it.
double within(double v, double low, double high) {
    constexpr double rounding = 1e-12;
    if (std::abs(v - low) < rounding) return low;
    return std::abs(v - high) < rounding ? high : v;
}

int next(const Pattern& pattern, int panel, int edge) { return (edge + 1) % int(pattern.panels[panel].outline.size()); }

} // namespace

double in_unit(const Alteration& a, double amount) { return (a.share ? 100 : 1e3) * amount; }
const char* unit_of(const Alteration& a) { return a.share ? "percent" : "mm"; }

Pattern altered(const Pattern& pattern, const std::vector<Alteration>& alterations, const Eigen::VectorXd& amounts) {
    if (amounts.size() != Eigen::Index(alterations.size()))
        throw std::invalid_argument("expected one amount for every alteration");
    Pattern result = pattern;
    for (std::size_t k = 0; k < alterations.size(); ++k) alter_lengths(alterations[k], amounts[Eigen::Index(k)], result);
    for (Elastic& e : result.elastics) e.ratio = within(e.ratio, least_ratio, 1);
    for (Panel& p : result.panels)
        for (double& share : p.shrink) share = within(share, -most_shrink, most_shrink);
    const auto each = [&](bool controls, auto&& move) {
        for (std::size_t k = 0; k < alterations.size(); ++k)
            for (const OutlineMove& m : alterations[k].moves)
                if ((m.point.control > 0) == controls) move(m.point, Vec2(amounts[Eigen::Index(k)] * m.step));
    };
    each(false, [&](const OutlinePoint& p, const Vec2& by) {
        edge_of(pattern, p.panel, p.edge);
        Loop& outline = result.panels[p.panel].outline;
        outline[p.edge].start += by;
        outline[(p.edge + outline.size() - 1) % outline.size()].end += by;
    });
    for (std::size_t p = 0; p < pattern.panels.size(); ++p)
        for (std::size_t e = 0; e < pattern.panels[p].outline.size(); ++e)
            carry_curve(pattern.panels[p].outline[e], result.panels[p].outline[e]);
    each(true, [&](const OutlinePoint& p, const Vec2& by) {
        edge_of(pattern, p.panel, p.edge);
        Vec2* control = control_of(result.panels[p.panel].outline[p.edge], p.control);
        if (!control)
            throw std::invalid_argument(called(pattern, p.panel, p.edge) + " has no control point " + std::to_string(p.control));
        *control += by;
    });
    return result;
}

std::vector<OutlineMove> lengthen_edge(const Pattern& pattern, int panel, int edge) {
    const Vec2 along = direction_of(pattern, panel, edge); // first: it refuses what does not exist
    return {{{panel, next(pattern, panel, edge), 0}, along}};
}

std::vector<OutlineMove> move_edge(const Pattern& pattern, int panel, int edge) {
    Vec2 out = -turned_left(direction_of(pattern, panel, edge));
    if (signed_area(pattern.panels[panel].outline) < 0) out = -out;
    return {{{panel, edge, 0}, out}, {{panel, next(pattern, panel, edge), 0}, out}};
}

std::vector<OutlineMove> widen_dart(const Pattern& pattern, int panel, int edge) {
    const Edge& in = edge_of(pattern, panel, edge);
    const int out = next(pattern, panel, edge);
    const Vec2 mouth = edge_of(pattern, panel, out).end - in.start;
    if (!(mouth.norm() > 0)) throw std::invalid_argument("the dart at " + called(pattern, panel, edge) + " has no mouth");
    const Vec2 half = 0.5 * mouth.normalized();
    return {{{panel, edge, 0}, -half}, {{panel, next(pattern, panel, out), 0}, half}};
}

std::vector<ElasticMove> lengthen_elastics(const Pattern& pattern, const std::vector<int>& elastics) {
    double cloth = 0;
    for (const int e : elastics) {
        if (e < 0 || e >= int(pattern.elastics.size())) throw std::invalid_argument("there is no elastic " + std::to_string(e));
        cloth += length_at_rest(pattern, pattern.elastics[e].span);
    }
    if (!(cloth > 0)) throw std::invalid_argument("an elastic on cloth of no length cannot be altered");
    std::vector<ElasticMove> moves;
    for (const int e : elastics) moves.push_back({e, 1 / cloth});
    return moves;
}

std::vector<OutlineMove> move_seam(const Pattern& pattern, int seam) {
    if (seam < 0 || seam >= int(pattern.seams.size()))
        throw std::invalid_argument("there is no seam " + std::to_string(seam));
    const Seam& s = pattern.seams[seam];
    if (s.a.size() != 1 || s.b.size() != 1)
        throw std::invalid_argument(s.name + " has more than one edge on a side: its place cannot be one alteration");
    std::vector<OutlineMove> moves = move_edge(pattern, s.a[0].panel, s.a[0].edge);
    for (OutlineMove m : move_edge(pattern, s.b[0].panel, s.b[0].edge)) {
        m.step = -m.step;
        moves.push_back(m);
    }
    return moves;
}

} // namespace toile
