// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/check.h"

#include "geometry/text.h"
#include "patterns/crossing.h"
#include "patterns/curve.h"
#include "patterns/shrink.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace toile {
namespace {

/// A length as a person says it.
std::string said(double metres) {
    if (!std::isfinite(metres)) return "no finite length";
    if (metres < 0.001) return text("%.3g mm", metres * 1000);
    if (metres < 1) return text("%.4g cm", metres * 100);
    return text("%.4g m", metres);
}

std::string said(const Vec2& p) {
    return "(" + text("%.1f", p.x() * 100) + ", " + text("%.1f", p.y() * 100) + ") cm";
}

std::string percent(double share) {
    return text("%.0f %%", share * 100);
}

std::string called(const Panel& panel) {
    constexpr std::size_t most = 60;
    return "panel \"" + panel.name.substr(0, most) + (panel.name.size() > most ? "...\"" : "\"");
}

std::string capital(std::string text) {
    if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] += 'A' - 'a';
    return text;
}

/// A loop or line of a panel with the words messages use for it and its edges.
struct Part {
    const Loop* edges;
    std::string prefix; ///< before "edge 3": empty, "hole 0, ", "inner line 2, "
    bool closed;
    bool line;
};

std::vector<Part> parts_of(const Panel& panel) {
    std::vector<Part> parts{{&panel.outline, "", true, false}};
    for (std::size_t i = 0; i < panel.holes.size(); ++i)
        parts.push_back({&panel.holes[i], "hole " + std::to_string(i) + ", ", true, false});
    for (std::size_t i = 0; i < panel.lines.size(); ++i) {
        const Loop& l = panel.lines[i].edges;
        const bool closed = !l.empty() && l.front().start == l.back().end;
        parts.push_back({&l, "inner line " + std::to_string(i) + ", ", closed, true});
    }
    return parts;
}

struct FiniteCurve {
    bool operator()(const Straight&) const { return true; }
    bool operator()(const Quadratic& q) const { return q.control.allFinite(); }
    bool operator()(const Cubic& k) const { return k.control0.allFinite() && k.control1.allFinite(); }
    bool operator()(const Arc& a) const { return std::isfinite(a.radius); }
};

bool finite(const Edge& e) {
    return e.start.allFinite() && e.end.allFinite() && std::visit(FiniteCurve{}, e.curve);
}

/// Ends, control points and, for arcs, the farthest the circle may reach.
struct Extent {
    Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity());
    Vec2 high = -low;

    void add(const Vec2& p) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    void add(const Edge& e) {
        add(e.start);
        add(e.end);
        if (auto* q = std::get_if<Quadratic>(&e.curve)) add(q->control);
        if (auto* k = std::get_if<Cubic>(&e.curve)) add(k->control0), add(k->control1);
        if (auto* a = std::get_if<Arc>(&e.curve)) {
            const int n = a->large ? 16 : 4;
            for (int i = 1; i < n; ++i)
                add(point_at(e, double(i) / n));
        }
    }
    double size() const { return (high - low).maxCoeff(); }
};

class Checker {
public:
    Checker(const Pattern& pattern, const CheckOptions& options) : pattern_(pattern), options_(options) {}

    std::vector<Issue> run() {
        if (pattern_.panels.empty()) error("The pattern has no panels");
        if (!check_edge_count()) return issues_;
        for (const Panel& panel : pattern_.panels)
            check_panel(panel);
        check_scale();
        for (const Seam& seam : pattern_.seams)
            check_seam(seam);
        check_overlaps();
        check_unsewn();
        for (const Elastic& e : pattern_.elastics)
            check_elastic(e);
        for (const Pin& p : pattern_.pins)
            check_span(p.span, "A pin");
        if (dropped_ > 0)
            issues_.push_back({Severity::note, std::to_string(dropped_) + " more issues are not listed"});
        return std::move(issues_);
    }

private:
    void add(Severity severity, const std::string& text) {
        if (int(issues_.size()) < options_.max_issues)
            issues_.push_back({severity, text});
        else
            ++dropped_;
    }
    void error(const std::string& text) { add(Severity::error, text); }
    void warn(const std::string& text) { add(Severity::warning, text); }

    bool check_edge_count() {
        std::size_t edges = 0;
        for (const Panel& panel : pattern_.panels)
            for (const Part& part : parts_of(panel))
                edges += part.edges->size();
        if (edges <= std::size_t(options_.max_edges)) return true;
        error("The pattern has " + std::to_string(edges) + " edges; at most " +
              std::to_string(options_.max_edges) + " are accepted");
        return false;
    }

    void check_panel(const Panel& panel) {
        if (!check_placement(panel) || !check_shrink(panel)) return;
        if (panel.rest) return check_rest(panel);
        bool sound = true;
        const std::vector<Part> parts = parts_of(panel);
        for (const Part& part : parts)
            sound = check_edges(panel, part) && sound;
        if (!sound || !check_extent(panel, parts)) return;
        if (check_area(panel) && check_crossings(panel, parts)) check_holes(panel);
    }

    bool check_placement(const Panel& panel) {
        const Placement& at = panel.placement;
        if (!at.rotation.allFinite() || !at.translation.allFinite() || !std::isfinite(panel.grain)) {
            error("The placement or grain of " + called(panel) + " is not finite; numbers were expected");
            return false;
        }
        if ((at.rotation * at.rotation.transpose() - Mat3::Identity()).norm() > 1e-6 ||
            at.rotation.determinant() < 0)
            error("The rotation of " + called(panel) + " is not a rotation");
        if (at.translation.norm() > options_.max_translation)
            error(capital(called(panel)) + " starts " + said(at.translation.norm()) +
                  " away from the origin; check the units");
        return true;
    }

    bool check_shrink(const Panel& panel) {
        if (!(panel.shrink.array().abs() <= most_shrink).all()) {
            error(capital(called(panel)) + text(" is shrunk by %g of its weft and %g of its warp; from %g to %g was expected",
                                                panel.shrink.x(), panel.shrink.y(), -most_shrink, most_shrink));
            return false;
        }
        if (panel.shrink != Vec2::Zero())
            add(Severity::note, capital(called(panel)) + " is " + shrink_in_words(panel) + " after it is cut");
        return true;
    }

    /// Its triangles were looked at when it was read.
    void check_rest(const Panel& panel) {
        Vec3 low = panel.rest->mesh.points[0], high = low;
        for (const Vec3& p : panel.rest->mesh.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
        check_size(panel, (high - low).maxCoeff());
    }

    bool check_size(const Panel& panel, double size) {
        largest_ = std::max(largest_, size);
        if (size <= options_.max_extent) return true;
        error(capital(called(panel)) + " measures " + said(size) + "; at most " + said(options_.max_extent) +
              " was expected: check the units");
        return false;
    }

    /// False when the geometry of the part cannot be looked at any further.
    bool check_edges(const Panel& panel, const Part& part) {
        const Loop& loop = *part.edges;
        const std::string in = "In " + called(panel) + ", " + part.prefix;
        if (loop.empty()) {
            error(in + "there are no edges");
            return false;
        }
        bool sound = true;
        for (std::size_t i = 0; i < loop.size(); ++i)
            if (!finite(loop[i])) {
                error(in + "edge " + std::to_string(i) + " has a coordinate that is not a finite number");
                sound = false;
            }
        if (!sound) return false;
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const bool last = i + 1 == loop.size();
            if (last && !part.closed) continue;
            const std::size_t next = last ? 0 : i + 1;
            if (loop[i].end == loop[next].start) continue;
            error(in + "edge " + std::to_string(i) + " ends at " + said(loop[i].end) + " but edge " +
                  std::to_string(next) + " starts at " + said(loop[next].start) + "; the loop is open");
            sound = false;
        }
        for (std::size_t i = 0; i < loop.size(); ++i)
            sound = check_edge(loop[i], in + "edge " + std::to_string(i)) && sound;
        return sound;
    }

    bool check_edge(const Edge& e, const std::string& name) {
        const double chord = (e.end - e.start).norm();
        if (auto* arc = std::get_if<Arc>(&e.curve)) {
            if (arc->radius < 0.5 * chord * (1 - 1e-3) || !(arc->radius > 0)) {
                error(name + " is an arc of radius " + said(arc->radius) + " between points " + said(chord) +
                      " apart; the radius must be at least half of that");
                return false;
            }
        }
        const double l = length(e);
        if (l >= options_.min_edge) return true;
        error(name + " is degenerate: it is " + said(l) + " long; at least " + said(options_.min_edge) +
              " was expected");
        return false;
    }

    bool check_extent(const Panel& panel, const std::vector<Part>& parts) {
        Extent extent;
        for (const Part& part : parts)
            for (const Edge& e : *part.edges)
                extent.add(e);
        return check_size(panel, extent.size());
    }

    bool check_area(const Panel& panel) {
        const double area = std::abs(signed_area(panel.outline)), round = length(panel.outline);
        if (area > 1e-6 * round * round) return true;
        error(capital(called(panel)) + " encloses no area: it has " + std::to_string(panel.outline.size()) +
              " edges round " + text("%.3g cm2", area * 1e4) +
              "; at least three edges round a surface were expected");
        return false;
    }

    bool check_crossings(const Panel& panel, const std::vector<Part>& parts) {
        std::vector<Chain> chains;
        for (const Part& part : parts)
            chains.push_back({part.edges, part.closed, part.line});
        const std::vector<LineCrossing> found = find_crossings(chains, options_.max_extent);
        constexpr std::size_t most = 5;
        for (std::size_t i = 0; i < std::min(most, found.size()); ++i)
            report_crossing(panel, parts, found[i]);
        if (found.size() > most)
            error(capital(called(panel)) + " crosses itself in " + std::to_string(found.size() - most) +
                  " more pairs of edges");
        return found.empty();
    }

    void report_crossing(const Panel& panel, const std::vector<Part>& parts, const LineCrossing& c) {
        const std::string at = " at " + said(c.at);
        const std::string a = parts[c.chain_a].prefix + "edge " + std::to_string(c.edge_a);
        const std::string b = parts[c.chain_b].prefix + "edge " + std::to_string(c.edge_b);
        const std::string in = "In " + called(panel) + ", ";
        const std::string expected = "; the lines of a panel must not meet except at shared corners";
        if (a == b)
            error(in + a + (c.touch ? " touches itself" : " crosses itself") + at + expected);
        else
            error(in + a + (c.touch ? " touches " : " crosses ") + b + at + expected);
    }

    void check_holes(const Panel& panel) {
        for (std::size_t i = 0; i < panel.holes.size(); ++i)
            if (!contains(panel.outline, panel.holes[i].front().start))
                error("In " + called(panel) + ", hole " + std::to_string(i) + " lies outside the outline");
        for (std::size_t i = 0; i < panel.lines.size(); ++i)
            if (!contains(panel.outline, point_at(panel.lines[i].edges.front(), 0.5)))
                error("In " + called(panel) + ", inner line " + std::to_string(i) +
                      " lies outside the outline");
    }

    void check_scale() {
        if (largest_ > 0 && largest_ < options_.min_extent)
            error("The largest panel measures " + said(largest_) + "; at least " + said(options_.min_extent) +
                  " was expected: check the units");
    }

    /// False when the span does not exist.
    bool check_span(const EdgeSpan& s, const std::string& who) {
        if (s.panel < 0 || s.panel >= int(pattern_.panels.size())) {
            error(who + " names panel number " + std::to_string(s.panel) + ", which does not exist");
            return false;
        }
        const Panel& panel = pattern_.panels[s.panel];
        if (s.edge < 0 || s.edge >= int(panel.outline.size())) {
            error(who + " names edge " + std::to_string(s.edge) + " of " + called(panel) +
                  ", which has edges 0 to " + std::to_string(int(panel.outline.size()) - 1));
            return false;
        }
        const auto fraction = [](double t) { return t >= 0 && t <= 1; };
        if (fraction(s.t0) && fraction(s.t1) && s.t0 != s.t1) return true;
        error(who + " takes edge " + std::to_string(s.edge) + " of " + called(panel) + " from " +
              text("%g", s.t0) + " to " + text("%g", s.t1) +
              "; two different fractions from 0 to 1 were expected");
        return false;
    }

    bool sound_geometry(const SeamSide& side) const {
        for (const EdgeSpan& s : side)
            if (!finite(pattern_.panels[s.panel].outline[s.edge])) return false;
        return true;
    }

    void check_seam(const Seam& seam) {
        const std::string name = capital(seam.name.empty() ? "seam without a name" : seam.name);
        if (seam.a.empty() || seam.b.empty()) return error(name + " has a side that names no edge");
        bool exists = true;
        for (const SeamSide* side : {&seam.a, &seam.b})
            for (const EdgeSpan& s : *side)
                exists = check_span(s, name) && exists;
        if (!exists) return;
        if (is_self(seam)) return error(name + " sews an edge to itself; two different edges were expected");
        const int index = int(&seam - pattern_.seams.data());
        for (const SeamSide* side : {&seam.a, &seam.b})
            for (const EdgeSpan& s : *side)
                uses_.push_back({s.panel, s.edge, std::min(s.t0, s.t1), std::max(s.t0, s.t1), index});
        if (!sound_geometry(seam.a) || !sound_geometry(seam.b)) return;
        check_lengths(seam, name);
        check_twist(seam, name);
    }

    static bool is_self(const Seam& seam) {
        const EdgeSpan &a = seam.a.front(), &b = seam.b.front();
        return seam.a.size() == 1 && seam.b.size() == 1 && a.panel == b.panel && a.edge == b.edge &&
               std::minmax(a.t0, a.t1) == std::minmax(b.t0, b.t1);
    }

    void check_lengths(const Seam& seam, const std::string& name) {
        const SeamLengths l = seam_lengths(pattern_, seam);
        if (!(l.ease > options_.note_ease)) return;
        const std::string text =
            name + " joins " + said(l.a) + " to " + said(l.b) + ", an ease of " + percent(l.ease);
        const bool slight = std::isfinite(l.ease) && std::abs(l.a - l.b) < options_.no_error;
        if (l.ease > options_.max_ease && !slight)
            error(text + "; at most " + percent(options_.max_ease) + " was expected");
        else if (l.ease > options_.warn_ease)
            warn(text);
        else
            add(Severity::note, text);
    }

    void check_twist(const Seam& seam, const std::string& name) {
        const SeamSpan s = seam_span_at_start(pattern_, seam);
        if (s.other < options_.twist * s.chosen && s.chosen - s.other > 0.01)
            warn(name + " may be twisted: its sides start out " + said(s.chosen) + " apart on average, and " +
                 said(s.other) + " with one of them reversed");
    }

    struct Use {
        int panel, edge;
        double low, high;
        int seam;
    };

    void check_overlaps() {
        std::stable_sort(uses_.begin(), uses_.end(), [](const Use& a, const Use& b) {
            return std::tie(a.panel, a.edge, a.low, a.high) < std::tie(b.panel, b.edge, b.low, b.high);
        });
        std::size_t reach = 0; // the use that reaches farthest along its edge so far
        for (std::size_t i = 1; i < uses_.size(); ++i) {
            const Use &a = uses_[reach], &b = uses_[i];
            const bool same_edge = a.panel == b.panel && a.edge == b.edge;
            if (same_edge && b.low < a.high - 1e-9) report_overlap(a, b);
            if (!same_edge || b.high > a.high) reach = i;
        }
    }

    void report_overlap(const Use& a, const Use& b) {
        const std::string where =
            "edge " + std::to_string(a.edge) + " of " + called(pattern_.panels[a.panel]);
        const std::string one = pattern_.seams[a.seam].name, two = pattern_.seams[b.seam].name;
        if (a.seam == b.seam)
            error(capital(one) + " takes the same part of " + where + " twice");
        else
            error(capital(one) + " and " + two + " overlap on " + where +
                  "; a part of an edge can be sewn once");
    }

    void check_unsewn() {
        if (pattern_.panels.size() < 2) return;
        std::vector<bool> sewn(pattern_.panels.size(), false);
        for (const Use& u : uses_)
            sewn[u.panel] = true;
        for (std::size_t i = 0; i < sewn.size(); ++i)
            if (!sewn[i]) warn(capital(called(pattern_.panels[i])) + " is sewn to nothing");
    }

    void check_elastic(const Elastic& e) {
        if (!check_span(e.span, "An elastic")) return;
        const std::string on = "The elastic on edge " + std::to_string(e.span.edge) + " of " +
                               called(pattern_.panels[e.span.panel]);
        if (!(e.ratio > 0 && e.ratio <= 1))
            error(on + " has ratio " + text("%g", e.ratio) + "; above 0 and at most 1 was expected");
        if (!(e.stiffness > 0 && std::isfinite(e.stiffness)))
            error(on + " has stiffness " + text("%g", e.stiffness) +
                  " N; a number above 0 was expected");
    }

    const Pattern& pattern_;
    const CheckOptions& options_;
    std::vector<Issue> issues_;
    int dropped_ = 0;
    double largest_ = 0;
    std::vector<Use> uses_;
};

double side_length(const Pattern& pattern, const SeamSide& side) {
    double sum = 0;
    for (const EdgeSpan& s : side)
        sum += std::abs(s.t1 - s.t0) * length(pattern.panels[s.panel].outline[s.edge]);
    return sum;
}

/// n + 1 points in space, equally spaced along the side.
Points side_points(const Pattern& pattern, const SeamSide& side, int n) {
    std::vector<double> lengths;
    for (const EdgeSpan& s : side)
        lengths.push_back(side_length(pattern, {s}));
    double total = 0;
    for (double l : lengths)
        total += l;
    Points points;
    std::size_t k = 0;
    double before = 0;
    for (int i = 0; i <= n; ++i) {
        const double at = total * i / n;
        while (k + 1 < side.size() && at > before + lengths[k])
            before += lengths[k++];
        const EdgeSpan& s = side[k];
        const double share = lengths[k] > 0 ? std::min(1.0, (at - before) / lengths[k]) : 0;
        const double t = s.t0 + (s.t1 - s.t0) * share;
        const Panel& panel = pattern.panels[s.panel];
        Vec3 p = Vec3::Zero();
        if (panel.rest)
            p = place_along(*panel.rest, s.edge, t);
        else
            p.head<2>() = sample(panel.outline[s.edge], t, t, 1).front();
        points.push_back(panel.placement.rotation * p + panel.placement.translation);
    }
    return points;
}

} // namespace

std::vector<Issue> check(const Pattern& pattern, const CheckOptions& options) {
    return Checker(pattern, options).run();
}

bool has_error(const std::vector<Issue>& issues) {
    return std::any_of(issues.begin(), issues.end(),
                       [](const Issue& i) { return i.severity == Severity::error; });
}

SeamLengths lengths_of(double a, double b) {
    const auto [low, high] = std::minmax(a, b);
    return {a, b, low > 0 ? high / low - 1 : std::numeric_limits<double>::infinity()};
}

SeamLengths seam_lengths(const Pattern& pattern, const Seam& seam) {
    return lengths_of(side_length(pattern, seam.a), side_length(pattern, seam.b));
}

SeamSpan seam_span_at_start(const Pattern& pattern, const Seam& seam) {
    constexpr int n = 16;
    const Points a = side_points(pattern, seam.a, n), b = side_points(pattern, seam.b, n);
    SeamSpan s;
    for (int i = 0; i <= n; ++i) {
        s.chosen += (a[i] - b[i]).norm() / (n + 1);
        s.other += (a[i] - b[n - i]).norm() / (n + 1);
    }
    return s;
}

} // namespace toile
