// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/border_plan.h"

#include "patterns/curve.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace toile {
namespace {

constexpr double same_fraction = 1e-9; // arc fractions nearer than this are one place
constexpr double touch = 1e-4;         // metres; an inner line that ends this near an edge ends on it

std::vector<BorderTrack> tracks_of(const Panel& panel, int p) {
    std::vector<BorderTrack> tracks;
    auto add = [&](const Loop& edges, BorderKind kind, int loop) {
        for (int e = 0; e < int(edges.size()); ++e)
            tracks.push_back({kind, p, loop, e, edges[e], length(edges[e]), {0.0, 1.0}, 0});
    };
    add(panel.outline, BorderKind::outline, 0);
    for (BorderTrack& track : tracks)
        if (panel.rest) track.cuts = fractions_along(*panel.rest, track.index);
    for (int h = 0; h < int(panel.holes.size()); ++h)
        add(panel.holes[h], BorderKind::hole, h);
    for (int l = 0; l < int(panel.lines.size()); ++l)
        add(panel.lines[l].edges, BorderKind::line, l);
    return tracks;
}

/// Cuts a track at t, or returns the cut that is there already.
double cut(BorderTrack& track, double t) {
    auto at = std::lower_bound(track.cuts.begin(), track.cuts.end(), t);
    if (at != track.cuts.end() && *at - t < same_fraction) return *at;
    if (at != track.cuts.begin() && t - *(at - 1) < same_fraction) return *(at - 1);
    track.cuts.insert(at, t);
    return t;
}

/// A place on a side of a seam: a cut of a track, or the junction of two spans.
struct SideCut {
    double s; // fraction of the side's length
    int span;
    double t;
};

struct Side {
    std::vector<EdgeSpan> spans;
    std::vector<int> track;
    std::vector<double> start; // fraction of the side's length where each span starts; one more at the end
};

Side make_side(const SeamSide& side, const BorderPlan& plan) {
    Side out{side, {}, {0.0}};
    for (const EdgeSpan& span : side) {
        out.track.push_back(plan.first_track[span.panel] + span.edge);
        out.start.push_back(out.start.back() +
                            plan.tracks[out.track.back()].length * std::abs(span.t1 - span.t0));
    }
    const double total = out.start.back();
    for (double& s : out.start)
        s = total > 0 ? s / total : 0;
    return out;
}

/// The cuts strictly inside a side in walking order; the junction of two spans counts once, as the end of the
/// first.
std::vector<SideCut> inner_cuts(const Side& side, const BorderPlan& plan) {
    std::vector<SideCut> out;
    for (int k = 0; k < int(side.spans.size()); ++k) {
        const EdgeSpan& span = side.spans[k];
        const double low = std::min(span.t0, span.t1), high = std::max(span.t0, span.t1);
        std::vector<double> inside;
        for (double t : plan.tracks[side.track[k]].cuts)
            if (t > low + same_fraction && t < high - same_fraction) inside.push_back(t);
        if (span.t1 < span.t0) std::reverse(inside.begin(), inside.end());
        for (double t : inside) {
            const double part = (t - span.t0) / (span.t1 - span.t0);
            out.push_back({side.start[k] + part * (side.start[k + 1] - side.start[k]), k, t});
        }
        if (k + 1 < int(side.spans.size())) out.push_back({side.start[k + 1], k, span.t1});
    }
    return out;
}

/// Cuts the side at fraction s of its length.
void cut_side(const Side& side, BorderPlan& plan, double s) {
    int k = 0;
    while (k + 1 < int(side.spans.size()) && s > side.start[k + 1])
        ++k;
    const double width = side.start[k + 1] - side.start[k];
    const double part = width > 0 ? (s - side.start[k]) / width : 0;
    const EdgeSpan& span = side.spans[k];
    cut(plan.tracks[side.track[k]], span.t0 + std::clamp(part, 0.0, 1.0) * (span.t1 - span.t0));
}

/// Makes the cuts of both sides correspond. Cuts nearer than `slack` (fraction) are taken as one place when
/// each is the other's nearest, so that notches that nearly meet do not leave slivers. Returns whether a cut
/// was added.
bool match_sides(const Side& a, const Side& b, BorderPlan& plan, double slack) {
    const std::vector<SideCut> ca = inner_cuts(a, plan), cb = inner_cuts(b, plan);
    bool added = false;
    std::size_t i = 0, j = 0;
    while (i < ca.size() || j < cb.size()) {
        if (i < ca.size() && j < cb.size()) {
            const double gap = std::abs(ca[i].s - cb[j].s);
            const bool nearer_a = i + 1 < ca.size() && std::abs(ca[i + 1].s - cb[j].s) < gap;
            const bool nearer_b = j + 1 < cb.size() && std::abs(cb[j + 1].s - ca[i].s) < gap;
            if (gap <= slack && !nearer_a && !nearer_b) {
                ++i, ++j;
                continue;
            }
        }
        added = true;
        if (j == cb.size() || (i < ca.size() && ca[i].s < cb[j].s))
            cut_side(b, plan, ca[i++].s);
        else
            cut_side(a, plan, cb[j++].s);
    }
    return added;
}

double side_length(const Side& side, const BorderPlan& plan) {
    double sum = 0;
    for (std::size_t k = 0; k < side.spans.size(); ++k)
        sum += plan.tracks[side.track[k]].length * std::abs(side.spans[k].t1 - side.spans[k].t0);
    return sum;
}

void cut_at_spans(const Pattern& pattern, BorderPlan& plan) {
    auto cut_ends = [&](const EdgeSpan& span) {
        BorderTrack& track = plan.tracks[plan.first_track[span.panel] + span.edge];
        cut(track, span.t0);
        cut(track, span.t1);
    };
    for (const Seam& seam : pattern.seams) {
        for (const EdgeSpan& span : seam.a)
            cut_ends(span);
        for (const EdgeSpan& span : seam.b)
            cut_ends(span);
    }
    for (const Elastic& elastic : pattern.elastics)
        cut_ends(elastic.span);
    for (const Pin& pin : pattern.pins)
        cut_ends(pin.span);
}

void match_all_seams(const Pattern& pattern, const TriangulateOptions& options, BorderPlan& plan) {
    const double slack = std::min(0.25 * options.edge_length, 0.003);
    for (int round = 0; round < 50; ++round) {
        bool added = false;
        for (const Seam& seam : pattern.seams) {
            const Side a = make_side(seam.a, plan), b = make_side(seam.b, plan);
            const double longest = std::max(side_length(a, plan), side_length(b, plan));
            if (!(std::min(side_length(a, plan), side_length(b, plan)) > 0))
                throw std::runtime_error(seam.name + " has a side without length");
            if (match_sides(a, b, plan, slack / longest)) added = true;
        }
        if (!added) return;
    }
    throw std::runtime_error(
        "the seams of pattern '" + pattern.name +
        "' overlap so that every cut asks for another; seams on one edge must not overlap in a ring");
}

/// The triangles of a rest mesh stay as they are.
void refuse_new_points(const Pattern& pattern, const BorderPlan& plan) {
    for (const BorderTrack& track : plan.tracks) {
        const Panel& panel = pattern.panels[track.panel];
        if (!panel.rest) continue;
        const std::vector<double> own = fractions_along(*panel.rest, track.index);
        for (const double t : track.cuts)
            if (std::find(own.begin(), own.end(), t) == own.end())
                throw std::runtime_error("panel '" + panel.name + "' keeps the triangles of " + panel.rest->file + ", and edge " +
                                         std::to_string(track.index) + " of it has no point at " + std::to_string(t) +
                                         " of its length, where a seam, pin or elastic needs one; expected both sides of a seam "
                                         "of two rest meshes to have their points at the same fractions");
    }
}

/// Nearest place on an edge to p: (fraction, distance).
std::pair<double, double> nearest_on_edge(const Edge& edge, const Vec2& p) {
    const int n = 64;
    const std::vector<Vec2> points = sample(edge, 0, 1, n);
    int best = 0;
    for (int k = 1; k <= n; ++k)
        if ((points[k] - p).squaredNorm() < (points[best] - p).squaredNorm()) best = k;
    double low = std::max(0, best - 1) / double(n), high = std::min(n, best + 1) / double(n);
    auto distance = [&](double t) {
        if (t <= 0) return (edge.start - p).norm();
        return (sample(edge, 0, t, 1).back() - p).norm();
    };
    while (high - low > 1e-12) { // the distance is unimodal so near its minimum
        const double third = (high - low) / 3;
        if (distance(low + third) < distance(high - third))
            high -= third;
        else
            low += third;
    }
    double t = 0.5 * (low + high);
    if (distance(0) <= touch)
        t = 0;
    else if (distance(1) <= touch)
        t = 1;
    return {t, distance(t)};
}

bool same_line(const BorderPlan& plan, int a, int b) {
    if (std::min(a, b) < 0 || std::max(a, b) >= int(plan.tracks.size())) return false;
    const BorderTrack &s = plan.tracks[a], &t = plan.tracks[b];
    return s.kind == BorderKind::line && t.kind == BorderKind::line && s.panel == t.panel && s.loop == t.loop;
}

/// An end of an inner line that lies on the outline, on a hole or on another line shares a sample with it. Of
/// two lines that meet with their ends the later one attaches.
void attach_line_end(BorderPlan& plan, int end_track, bool last) {
    const BorderTrack& own = plan.tracks[end_track];
    const Vec2 p = last ? own.edge.end : own.edge.start;
    for (int k = plan.first_track[own.panel]; k < plan.first_track[own.panel + 1]; ++k) {
        BorderTrack& other = plan.tracks[k];
        if (same_line(plan, k, end_track)) continue;
        const auto [t, distance] = nearest_on_edge(other.edge, p);
        if (distance > touch) continue;
        const bool at_end = (t == 0 && !same_line(plan, k - 1, k)) || (t == 1 && !same_line(plan, k, k + 1));
        if (other.kind == BorderKind::line && other.loop > own.loop && at_end) continue;
        const double near = touch / other.length;
        const auto there = std::find_if(other.cuts.begin(), other.cuts.end(),
                                        [&, t = t](double c) { return std::abs(c - t) <= near; });
        plan.line_ends.push_back({end_track, last, k, there != other.cuts.end() ? *there : cut(other, t)});
        return;
    }
}

void attach_lines(BorderPlan& plan) {
    for (int k = 0; k < int(plan.tracks.size()); ++k) {
        if (plan.tracks[k].kind != BorderKind::line) continue;
        if (!same_line(plan, k - 1, k)) attach_line_end(plan, k, false);
        if (!same_line(plan, k, k + 1)) attach_line_end(plan, k, true);
    }
}

void make_intervals(BorderPlan& plan) {
    for (int k = 0; k < int(plan.tracks.size()); ++k) {
        BorderTrack& track = plan.tracks[k];
        track.first_interval = int(plan.intervals.size());
        for (std::size_t c = 0; c + 1 < track.cuts.size(); ++c)
            plan.intervals.push_back({k, track.cuts[c], track.cuts[c + 1], 0, false, {}, {}});
    }
}

/// Intervals of a side in walking order, with whether they are walked backward.
std::vector<std::pair<int, bool>> intervals_of(const Side& side, const BorderPlan& plan) {
    std::vector<std::pair<int, bool>> out;
    for (std::size_t k = 0; k < side.spans.size(); ++k) {
        const EdgeSpan& span = side.spans[k];
        const BorderTrack& track = plan.tracks[side.track[k]];
        const double low = std::min(span.t0, span.t1), high = std::max(span.t0, span.t1);
        std::vector<std::pair<int, bool>> part;
        for (int c = 0; c + 1 < int(track.cuts.size()); ++c)
            if (track.cuts[c] > low - same_fraction && track.cuts[c + 1] < high + same_fraction)
                part.push_back({track.first_interval + c, span.t1 < span.t0});
        if (span.t1 < span.t0) std::reverse(part.begin(), part.end());
        out.insert(out.end(), part.begin(), part.end());
    }
    return out;
}

void pair_intervals(const Pattern& pattern, BorderPlan& plan) {
    for (const Seam& seam : pattern.seams) {
        const auto a = intervals_of(make_side(seam.a, plan), plan);
        const auto b = intervals_of(make_side(seam.b, plan), plan);
        if (a.size() != b.size() || a.empty())
            throw std::runtime_error(seam.name + ": its sides could not be cut into matching parts (" +
                                     std::to_string(a.size()) + " and " + std::to_string(b.size()) + ")");
        std::vector<SewnIntervals> pairs;
        for (std::size_t k = 0; k < a.size(); ++k)
            pairs.push_back({a[k].first, b[k].first, a[k].second, b[k].second});
        plan.seams.push_back(std::move(pairs));
    }
}

/// Connected intervals become groups, numbered by their smallest member; walking from that member gives each
/// one its direction.
void group_intervals(BorderPlan& plan) {
    const int n = int(plan.intervals.size());
    std::vector<std::vector<std::pair<int, bool>>> sewn(n);
    for (const auto& pairs : plan.seams)
        for (const SewnIntervals& s : pairs) {
            const bool turned = s.a_backward != s.b_backward;
            sewn[s.a].push_back({s.b, turned});
            sewn[s.b].push_back({s.a, turned});
        }
    std::vector<bool> seen(n, false);
    for (int first = 0; first < n; ++first) {
        if (seen[first]) continue;
        const int group = int(plan.groups.size());
        plan.groups.emplace_back();
        std::vector<int> members;
        members.push_back(first);
        seen[first] = true;
        for (std::size_t k = 0; k < members.size(); ++k) {
            const int i = members[k];
            plan.intervals[i].group = group;
            for (const auto& [j, turned] : sewn[i]) {
                const bool reversed = plan.intervals[i].reversed != turned;
                if (!seen[j]) {
                    seen[j] = true;
                    plan.intervals[j].reversed = reversed;
                    members.push_back(j);
                } else if (plan.intervals[j].reversed != reversed)
                    plan.groups[group].symmetric = true;
            }
        }
        std::sort(members.begin(), members.end());
        plan.groups[group].members = std::move(members);
    }
}

double interval_length(const BorderPlan& plan, const BorderInterval& interval) {
    return plan.tracks[interval.track].length * (interval.t1 - interval.t0);
}

/// 1 / size along a group, the largest of its members, at the midpoints of equal parts; {1} without a size
/// function.
std::vector<double> density(const BorderPlan& plan, const BorderGroup& group,
                            const TriangulateOptions& options) {
    if (!options.size) return {1.0};
    double longest = 0;
    for (int i : group.members)
        longest = std::max(longest, interval_length(plan, plan.intervals[i]));
    const int parts = std::clamp(int(4 * longest / options.edge_length), 16, 4096);
    std::vector<double> out(parts, 1.0);
    for (int i : group.members) {
        const BorderInterval& interval = plan.intervals[i];
        const BorderTrack& track = plan.tracks[interval.track];
        const std::vector<Vec2> points = sample(track.edge, interval.t0, interval.t1, 2 * parts);
        for (int k = 0; k < parts; ++k) {
            const int from = interval.reversed ? parts - 1 - k : k;
            out[k] =
                std::max(out[k], 1 / std::clamp(options.size(track.panel, points[2 * from + 1]), 1e-3, 1.0));
        }
    }
    if (group.symmetric)
        for (int k = 0; k < parts; ++k)
            out[k] = std::max(out[k], out[parts - 1 - k]);
    return out;
}

/// Fractions that share the density's integral into n equal parts.
std::vector<double> equal_parts(const std::vector<double>& density, int n) {
    std::vector<double> at(n + 1);
    const double total = std::accumulate(density.begin(), density.end(), 0.0);
    std::size_t k = 0;
    double before = 0;
    for (int j = 1; j < n; ++j) {
        const double want = total * j / n;
        while (k + 1 < density.size() && before + density[k] < want)
            before += density[k++];
        at[j] = (k + (want - before) / density[k]) / density.size();
    }
    at[0] = 0, at[n] = 1;
    return at;
}

struct Demand {
    double segments = 1;    // wanted on the finest level
    std::vector<int> least; // per level
};

/// Squared logarithm of spacing over target, summed over levels, each counting half of the next finer one. A
/// level off by more than a factor of 1.5 costs much more, unless it has a single segment already: meshes
/// adapt to a little, but not to a border twice as fine as their inside.
double misfit(double segments, int base, int halvings, int levels) {
    double sum = 0, weight = 1, wanted = segments;
    for (int level = levels - 1; level >= 0; --level) {
        const int n = base << std::max(0, halvings - (levels - 1 - level));
        const double ratio = std::log2(n / wanted);
        const bool far = std::abs(ratio) > std::log2(1.5) && !(n == 1 && ratio > 0);
        sum += weight * ratio * ratio * (far ? 10 : 1);
        weight /= 2, wanted /= 2;
    }
    return sum;
}

bool enough(const Demand& demand, int base, int halvings, int levels) {
    for (int level = 0; level < levels; ++level)
        if ((base << std::max(0, halvings - (levels - 1 - level))) < demand.least[level]) return false;
    return true;
}

void choose(BorderGroup& group, const Demand& demand, int levels) {
    double best = -1;
    for (int halvings = levels - 1; halvings >= 0; --halvings) {
        const double ideal = demand.segments / (1 << halvings);
        int base = std::max(1, int(ideal));
        while (!enough(demand, base, halvings, levels))
            ++base;
        for (int b : {base, base + 1}) {
            const double cost = misfit(demand.segments, b, halvings, levels);
            if (best >= 0 && cost >= best) continue;
            best = cost;
            group.base = b, group.halvings = halvings;
        }
    }
}

/// `at`: fractions of the group's length, 0 .. 1; even ones are sampled in one go.
void sample_interval(const BorderPlan& plan, BorderInterval& interval, bool even,
                     const std::vector<double>& at) {
    const Edge& edge = plan.tracks[interval.track].edge;
    const int n = int(at.size()) - 1;
    interval.at.resize(n + 1);
    for (int k = 0; k <= n; ++k) {
        const double s = interval.reversed ? 1 - at[n - k] : at[k];
        interval.at[k] = interval.t0 + s * (interval.t1 - interval.t0);
    }
    interval.at.front() = interval.t0, interval.at.back() = interval.t1;
    if (even) {
        interval.points = sample(edge, interval.t0, interval.t1, n);
        return;
    }
    interval.points = sample(edge, interval.t0, interval.t1, 1);
    interval.points.resize(n + 1, interval.points.back());
    for (int k = 1; k < n; ++k)
        interval.points[k] = sample(edge, interval.t0, interval.at[k], 1).back();
}

} // namespace

int BorderPlan::count(int group, int level) const {
    return groups[group].base << std::max(0, groups[group].halvings - (levels - 1 - level));
}

BorderPlan plan_borders(const Pattern& pattern, const TriangulateOptions& options) {
    BorderPlan plan;
    plan.levels = options.levels;
    for (int p = 0; p < int(pattern.panels.size()); ++p) {
        plan.first_track.push_back(int(plan.tracks.size()));
        for (BorderTrack& track : tracks_of(pattern.panels[p], p))
            plan.tracks.push_back(std::move(track));
    }
    plan.first_track.push_back(int(plan.tracks.size()));
    cut_at_spans(pattern, plan);
    attach_lines(plan);
    match_all_seams(pattern, options, plan);
    refuse_new_points(pattern, plan);
    make_intervals(plan);
    pair_intervals(pattern, plan);
    group_intervals(plan);
    for (BorderGroup& group : plan.groups)
        for (const int i : group.members)
            if (pattern.panels[plan.tracks[plan.intervals[i].track].panel].rest) group.single = true;
    return plan;
}

void choose_counts(BorderPlan& plan, const TriangulateOptions& options, const LeastCounts& least) {
    for (int g = 0; g < int(plan.groups.size()); ++g) {
        BorderGroup& group = plan.groups[g];
        const std::vector<double> dense = density(plan, group, options);
        const double mean = std::accumulate(dense.begin(), dense.end(), 0.0) / dense.size();
        double shortest = 1e300, longest = 0;
        Demand demand;
        demand.least.assign(plan.levels, 1);
        for (int i : group.members) {
            const BorderInterval& interval = plan.intervals[i];
            const double l = interval_length(plan, interval);
            shortest = std::min(shortest, l), longest = std::max(longest, l);
            for (int level = 0; level < plan.levels; ++level) {
                const double edge = options.edge_length * (1 << (plan.levels - 1 - level));
                const int whole = intervals_for_sag(plan.tracks[interval.track].edge, edge / 8);
                demand.least[level] =
                    std::max(demand.least[level], int(std::ceil(whole * (interval.t1 - interval.t0) - 1e-6)));
            }
        }
        for (int level = 0; level < plan.levels; ++level)
            demand.least[level] = std::max(demand.least[level], least[level][g]);
        // Between the shortest and the longest member no side is off by more than the root of their ratio.
        demand.segments = std::sqrt(shortest * longest) * mean / options.edge_length;
        if (!group.single) choose(group, demand, plan.levels);
        const std::vector<double> at = equal_parts(dense, plan.count(g, plan.levels - 1));
        for (int i : group.members)
            sample_interval(plan, plan.intervals[i], dense.size() == 1, at);
    }
}

} // namespace toile
