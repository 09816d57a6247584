// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/triangulate.h"

#include "geometry/disjoint_sets.h"
#include "geometry/parallel.h"
#include "patterns/border_plan.h"
#include "patterns/curve.h"
#include "patterns/open_cuts.h"
#include "patterns/panel_mesh.h"
#include "patterns/prolong.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

namespace toile {
namespace {

/// The sampled borders of all panels at one level, before any panel is filled.
struct LevelBorders {
    double edge_length = 0;
    std::vector<PanelBorder> panels;
    std::vector<std::vector<int>> of_interval; ///< points of each interval from t0 to t1, within its panel
    std::vector<std::vector<int>> right_of;    ///< the same, but of a cut's right side once it is open
};

std::vector<Vec2> points_at(const BorderPlan& plan, int interval, int level) {
    const std::vector<Vec2>& fine = plan.intervals[interval].points;
    const int n = plan.count(plan.intervals[interval].group, level), step = (int(fine.size()) - 1) / n;
    std::vector<Vec2> out;
    for (int k = 0; k <= n; ++k)
        out.push_back(fine[k * step]);
    return out;
}

/// Numbers the points of one panel's border in walking order. Consecutive edges share their corner; a closed
/// loop's last point is its first; a line that ends on another edge shares that edge's point.
class BorderBuilder {
public:
    BorderBuilder(const BorderPlan& plan, int level, LevelBorders& out)
        : plan_(plan), level_(level), out_(out) {
        for (const BorderTrack& track : plan.tracks)
            point_at_cut_.emplace_back(track.cuts.size(), -1);
    }

    void panel(int p) {
        border_ = &out_.panels[p];
        for (int k = plan_.first_track[p]; k < plan_.first_track[p + 1]; ++k)
            for (int c = 0; c + 1 < int(plan_.tracks[k].cuts.size()); ++c)
                interval(k, c);
    }

private:
    void interval(int k, int c) {
        const BorderTrack& track = plan_.tracks[k];
        const int i = track.first_interval + c;
        const std::vector<Vec2> points = points_at(plan_, i, level_);
        std::vector<int>& ids = out_.of_interval[i];
        ids.push_back(at_cut(k, c));
        for (std::size_t j = 1; j + 1 < points.size(); ++j)
            ids.push_back(add(points[j]));
        ids.push_back(at_cut(k, c + 1));
        for (std::size_t j = 0; j + 1 < ids.size(); ++j)
            border_->segments.push_back({ids[j], ids[j + 1], i, track.kind != BorderKind::line});
    }

    /// The point at cut c of track k, made when it is first asked for.
    int at_cut(int k, int c) {
        int& known = point_at_cut_[k][c];
        if (known < 0) known = shared(k, c);
        if (known < 0) known = add(place(k, c));
        return known;
    }

    /// The point that an end of a track shares with another track; -1 when it is its own.
    int shared(int k, int c) {
        const BorderTrack& track = plan_.tracks[k];
        const bool last = c + 1 == int(track.cuts.size());
        if (!last && c > 0) return -1;
        if (last && same_loop(k, k + 1)) return at_cut(k + 1, 0);
        for (const LineEnd& e : plan_.line_ends)
            if (e.track == k && e.last == last)
                return at_cut(e.on_track, cut_at(plan_.tracks[e.on_track], e.t));
        if (!last) return -1;
        int first = k;
        while (same_loop(first - 1, k))
            --first;
        const bool closed =
            track.kind != BorderKind::line || track.edge.end == plan_.tracks[first].edge.start;
        return closed ? at_cut(first, 0) : -1;
    }

    bool same_loop(int a, int b) const {
        if (std::min(a, b) < 0 || std::max(a, b) >= int(plan_.tracks.size())) return false;
        const BorderTrack &s = plan_.tracks[a], &t = plan_.tracks[b];
        return s.panel == t.panel && s.kind == t.kind && s.loop == t.loop;
    }

    static int cut_at(const BorderTrack& track, double t) {
        return int(std::lower_bound(track.cuts.begin(), track.cuts.end(), t) - track.cuts.begin());
    }

    Vec2 place(int k, int c) const {
        const BorderTrack& track = plan_.tracks[k];
        const bool last = c + 1 == int(track.cuts.size());
        const std::vector<Vec2>& points = plan_.intervals[track.first_interval + c - last].points;
        return last ? points.back() : points.front();
    }

    int add(const Vec2& p) {
        border_->points.push_back(p);
        return int(border_->points.size()) - 1;
    }

    const BorderPlan& plan_;
    int level_;
    LevelBorders& out_;
    PanelBorder* border_ = nullptr;
    std::vector<std::vector<int>> point_at_cut_; ///< per track and cut; -1: not made yet
};

/// All points of a rest mesh count as points of its panel's border, by their own numbers.
void border_of_rest(const BorderPlan& plan, int p, const RestMesh& rest, LevelBorders& out) {
    out.panels[p].points = rest.flat;
    for (int k = plan.first_track[p]; k < plan.first_track[p + 1]; ++k) {
        const std::vector<int>& points = rest.edges[plan.tracks[k].index];
        for (std::size_t c = 0; c + 1 < points.size(); ++c)
            out.of_interval[plan.tracks[k].first_interval + c] = {points[c], points[c + 1]};
    }
}

LevelBorders make_borders(const Pattern& pattern, const BorderPlan& plan, const TriangulateOptions& options,
                          int level) {
    LevelBorders out;
    out.edge_length = options.edge_length * (1 << (plan.levels - 1 - level));
    out.panels.resize(pattern.panels.size());
    out.of_interval.resize(plan.intervals.size());
    BorderBuilder builder(plan, level, out);
    for (int p = 0; p < int(pattern.panels.size()); ++p)
        if (const auto& rest = pattern.panels[p].rest)
            border_of_rest(plan, p, *rest, out);
        else
            builder.panel(p);
    return out;
}

std::string edge_name(const BorderTrack& track) {
    switch (track.kind) {
    case BorderKind::outline:
        return "edge " + std::to_string(track.index);
    case BorderKind::hole:
        return "edge " + std::to_string(track.index) + " of hole " + std::to_string(track.loop);
    default:
        return "edge " + std::to_string(track.index) + " of inner line " + std::to_string(track.loop);
    }
}

/// Chords of curves may cross where the curves do not: asks for more segments there. Throws when the curves
/// cross.
bool uncross(const Pattern& pattern, const BorderPlan& plan, const LevelBorders& borders, int level,
             LeastCounts& least) {
    const int enough = 512; // segments of a curve whose chords still cross: it is the curve that crosses
    bool changed = false;
    for (std::size_t p = 0; p < borders.panels.size(); ++p) {
        const PanelBorder& border = borders.panels[p];
        const auto [i, j] = crossing_segments(border);
        if (i < 0) continue;
        bool finer = false;
        for (int s : {i, j}) {
            const BorderInterval& interval = plan.intervals[border.segments[s].interval];
            const int n = plan.count(interval.group, level);
            if (std::holds_alternative<Straight>(plan.tracks[interval.track].edge.curve) || n >= enough)
                continue;
            least[level][interval.group] = 2 * n;
            finer = changed = true;
        }
        if (!finer) {
            const BorderTrack& a = plan.tracks[plan.intervals[border.segments[i].interval].track];
            const BorderTrack& b = plan.tracks[plan.intervals[border.segments[j].interval].track];
            throw std::runtime_error(
                "panel '" + pattern.panels[p].name + "' crosses itself: " + edge_name(a) + " and " +
                edge_name(b) + " meet near (" + std::to_string(border.points[border.segments[i].a].x()) +
                ", " + std::to_string(border.points[border.segments[i].a].y()) + ") m of the panel");
        }
    }
    return changed;
}

std::vector<int> walked(const std::vector<int>& points, bool backward) {
    return backward ? std::vector<int>(points.rbegin(), points.rend()) : points;
}

/// Segments that a seam sews, points numbered from offset[panel].
std::vector<SewnSegment> sewn_segments(const BorderPlan& plan, const std::vector<SewnIntervals>& seam,
                                       const LevelBorders& borders, const std::vector<int>& offset) {
    std::vector<SewnSegment> out;
    for (const SewnIntervals& s : seam) {
        const std::vector<int> a = walked(borders.of_interval[s.a], s.a_backward);
        const std::vector<int> b = walked(borders.of_interval[s.b], s.b_backward);
        const int pa = offset[plan.tracks[plan.intervals[s.a].track].panel];
        const int pb = offset[plan.tracks[plan.intervals[s.b].track].panel];
        for (std::size_t k = 0; k + 1 < a.size(); ++k)
            out.push_back({{pa + a[k], pa + a[k + 1]}, {pb + b[k], pb + b[k + 1]}});
    }
    return out;
}

/// Pairs of points at the ends of sewn segments; each once in a row, none of a point with itself.
std::vector<std::array<int, 2>> stitches_of(const std::vector<SewnSegment>& segments) {
    std::vector<std::array<int, 2>> out;
    for (const SewnSegment& s : segments)
        for (int k = 0; k < 2; ++k) {
            const std::array<int, 2> pair{s.a[k], s.b[k]};
            if (pair[0] != pair[1] && (out.empty() || out.back() != pair)) out.push_back(pair);
        }
    return out;
}

std::vector<int> border_offsets(const LevelBorders& borders) {
    std::vector<int> offset{0};
    for (const PanelBorder& b : borders.panels)
        offset.push_back(offset.back() + int(b.points.size()));
    return offset;
}

/// The node every border point becomes once all seams are closed.
DisjointSets closed_nodes(const BorderPlan& plan, const LevelBorders& borders) {
    const std::vector<int> offset = border_offsets(borders);
    DisjointSets nodes(offset.back());
    for (const auto& seam : plan.seams)
        for (const auto& [a, b] : stitches_of(sewn_segments(plan, seam, borders, offset)))
            nodes.join(a, b);
    return nodes;
}

/// A coarse border may close onto itself: a cuff of two segments becomes a flat pair of edges. Asks for more
/// segments where a segment's ends would become one node, or two segments one edge that no seam joins.
bool keep_open(const BorderPlan& plan, const LevelBorders& borders, int level, LeastCounts& least) {
    const int enough = 4; // segments; what still coincides then is drawn so
    DisjointSets nodes = closed_nodes(plan, borders);
    const std::vector<int> offset = border_offsets(borders);
    std::vector<int> first_segment(plan.intervals.size(), 0); // all segments of all intervals, numbered
    int segments = 0;
    for (std::size_t i = 0; i < plan.intervals.size(); ++i)
        first_segment[i] = segments, segments += int(borders.of_interval[i].size()) - 1;
    DisjointSets sewn(segments);
    for (const auto& seam : plan.seams)
        for (const SewnIntervals& s : seam) {
            const int n = plan.count(plan.intervals[s.a].group, level);
            for (int k = 0; k < n; ++k)
                sewn.join(first_segment[s.a] + (s.a_backward ? n - 1 - k : k),
                          first_segment[s.b] + (s.b_backward ? n - 1 - k : k));
        }
    std::map<std::array<int, 2>, std::vector<std::array<int, 2>>> edges; // nodes -> (segment, interval)
    bool changed = false;
    auto finer = [&](int interval) {
        const int group = plan.intervals[interval].group;
        const int n = plan.count(group, level);
        if (n >= enough || least[level][group] > n) return;
        least[level][group] = n + 1;
        changed = true;
    };
    for (std::size_t i = 0; i < plan.intervals.size(); ++i) {
        const int base = offset[plan.tracks[plan.intervals[i].track].panel];
        const std::vector<int>& ids = borders.of_interval[i];
        for (std::size_t k = 0; k + 1 < ids.size(); ++k) {
            const int a = nodes.find(base + ids[k]), b = nodes.find(base + ids[k + 1]);
            if (a == b)
                finer(int(i));
            else
                edges[{std::min(a, b), std::max(a, b)}].push_back({first_segment[i] + int(k), int(i)});
        }
    }
    for (const auto& [ends, uses] : edges)
        for (const auto& [segment, interval] : uses)
            if (sewn.find(segment) != sewn.find(uses[0][0])) {
                finer(uses[0][1]);
                finer(interval);
            }
    return changed;
}

/// Inner edges between two border points can coincide with other edges, or vanish, once seams close: they are
/// split at their middle.
void split_chords(const BorderPlan& plan, const LevelBorders& borders, std::vector<PlanarMesh>& meshes) {
    DisjointSets nodes = closed_nodes(plan, borders);
    const std::vector<int> offset = border_offsets(borders);
    struct Chord {
        int panel, a, b;
    };
    std::map<std::array<int, 2>, int> used; // edges of closed cloth: how many chords, or a border edge
    std::vector<Chord> chords;
    auto key = [&](int panel, int a, int b) {
        const int na = nodes.find(offset[panel] + a), nb = nodes.find(offset[panel] + b);
        return std::array{std::min(na, nb), std::max(na, nb)};
    };
    for (int p = 0; p < int(meshes.size()); ++p)
        for (int t = 0; t < int(meshes[p].triangles.size()); ++t)
            for (int k = 0; k < 3; ++k) {
                const int a = meshes[p].triangles[t][(k + 1) % 3], b = meshes[p].triangles[t][(k + 2) % 3];
                if (!meshes[p].on_border(a) || !meshes[p].on_border(b)) continue;
                if (meshes[p].fixed[t][k])
                    used[key(p, a, b)] = 1;
                else if (meshes[p].across[t][k] > t)
                    chords.push_back({p, a, b});
            }
    for (const Chord& c : chords) {
        const std::array<int, 2> ends = key(c.panel, c.a, c.b);
        if (ends[0] == ends[1] || used[ends]++ > 0) split_edge(meshes[c.panel], c.a, c.b);
    }
}

std::vector<PlanarMesh> mesh_panels(const Pattern& pattern, const LevelBorders& borders,
                                    const TriangulateOptions& options) {
    std::vector<PlanarMesh> meshes(borders.panels.size());
    const auto mesh_of = [&](const Panel& panel, const PanelBorder& border, const SizeAt& size) {
        if (!panel.rest)
            return options.grain_lattice ? mesh_panel_along_grain(border, borders.edge_length, panel.grain, options.smoothing)
                                         : mesh_panel(border, borders.edge_length, size, options.smoothing);
        PlanarMesh own;
        own.points = panel.rest->flat;
        own.triangles = panel.rest->mesh.triangles;
        return own;
    };
    std::vector<std::string> errors(meshes.size());
    parallel_for(int(meshes.size()), 1, [&](int begin, int end) {
        for (int p = begin; p < end; ++p) {
            SizeAt size;
            if (options.size)
                size = [&, p](const Vec2& at) { return std::clamp(options.size(p, at), 1e-3, 1.0); };
            try {
                meshes[p] = mesh_of(pattern.panels[p], borders.panels[p], size);
            } catch (const std::exception& e) {
                errors[p] = e.what();
            }
        }
    });
    for (std::size_t p = 0; p < meshes.size(); ++p)
        if (!errors[p].empty())
            throw std::runtime_error("panel '" + pattern.panels[p].name +
                                     "' cannot be triangulated: " + errors[p]);
    return meshes;
}

/// Opens inner lines of kind cut, and names the points of every interval anew: an outline that a cut divides
/// has two points there.
void open_panel(const Pattern& pattern, const BorderPlan& plan, int panel, PlanarMesh& mesh,
                LevelBorders& borders) {
    std::vector<std::array<int, 2>> cuts;
    const auto each_interval = [&](auto&& visit) {
        for (int k = plan.first_track[panel]; k < plan.first_track[panel + 1]; ++k)
            for (int c = 0; c + 1 < int(plan.tracks[k].cuts.size()); ++c)
                visit(plan.tracks[k], plan.tracks[k].first_interval + c);
    };
    each_interval([&](const BorderTrack& track, int i) {
        if (track.kind != BorderKind::line ||
            pattern.panels[panel].lines[track.loop].kind != InnerLineKind::cut)
            return;
        const std::vector<int>& ids = borders.of_interval[i];
        for (std::size_t k = 0; k + 1 < ids.size(); ++k)
            cuts.push_back({ids[k], ids[k + 1]});
    });
    if (cuts.empty()) return;
    const std::vector<int> original = open_cuts(mesh, cuts);
    std::map<std::array<int, 2>, std::array<int, 2>> now; // directed fixed edges before and after
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k)
            if (mesh.fixed[t][k]) {
                const int a = mesh.triangles[t][(k + 1) % 3], b = mesh.triangles[t][(k + 2) % 3];
                now[{original[a], original[b]}] = {a, b};
            }
    each_interval([&](const BorderTrack&, int i) {
        const std::vector<int> before = borders.of_interval[i];
        for (std::size_t k = 0; k + 1 < before.size(); ++k) {
            const auto left = now.find({before[k], before[k + 1]}),
                       right = now.find({before[k + 1], before[k]});
            const std::array<int, 2> l =
                left != now.end() ? left->second : std::array{right->second[1], right->second[0]};
            const std::array<int, 2> r =
                right != now.end() ? std::array{right->second[1], right->second[0]} : l;
            std::copy(l.begin(), l.end(), borders.of_interval[i].begin() + k);
            std::copy(r.begin(), r.end(), borders.right_of[i].begin() + k);
        }
    });
}

/// The points along outlines and inner lines, panel points being numbered from offset[panel].
void name_borders(const Pattern& pattern, const BorderPlan& plan, const LevelBorders& borders,
                  const std::vector<int>& offset, FlatLevel& level) {
    for (const Panel& panel : pattern.panels) {
        level.border.emplace_back(panel.outline.size());
        level.border_at.emplace_back(panel.outline.size());
        level.lines.emplace_back(panel.lines.size());
    }
    for (const BorderTrack& track : plan.tracks) {
        if (track.kind == BorderKind::hole) continue;
        const bool line = track.kind == BorderKind::line;
        std::vector<int>& out =
            line ? level.lines[track.panel][track.loop] : level.border[track.panel][track.index];
        for (int c = 0; c + 1 < int(track.cuts.size()); ++c) {
            const int i = track.first_interval + c;
            const std::vector<int>& ids = borders.of_interval[i];
            const std::size_t step = (plan.intervals[i].at.size() - 1) / (ids.size() - 1);
            for (std::size_t k = 0; k < ids.size(); ++k) {
                if (!out.empty() && out.back() == offset[track.panel] + ids[k]) continue;
                out.push_back(offset[track.panel] + ids[k]);
                if (!line)
                    level.border_at[track.panel][track.index].push_back(plan.intervals[i].at[k * step]);
            }
        }
    }
}

FlatLevel assemble(const Pattern& pattern, const BorderPlan& plan, const LevelBorders& borders,
                   const std::vector<PlanarMesh>& meshes) {
    FlatLevel level;
    level.edge_length = borders.edge_length;
    std::vector<int> offset{0};
    for (int p = 0; p < int(meshes.size()); ++p) {
        const bool clockwise = !pattern.panels[p].rest && signed_area(pattern.panels[p].outline) < 0;
        level.points.insert(level.points.end(), meshes[p].points.begin(), meshes[p].points.end());
        level.panel_of_point.insert(level.panel_of_point.end(), meshes[p].points.size(), p);
        for (const Triangle& t : meshes[p].triangles) {
            Triangle global{t[0] + offset[p], t[1] + offset[p], t[2] + offset[p]};
            if (clockwise) std::swap(global[1], global[2]);
            level.triangles.push_back(global);
        }
        level.panel_of_triangle.insert(level.panel_of_triangle.end(), meshes[p].triangles.size(), p);
        offset.push_back(int(level.points.size()));
    }
    name_borders(pattern, plan, borders, offset, level);
    for (const auto& seam : plan.seams) {
        level.sewn.push_back(sewn_segments(plan, seam, borders, offset));
        level.stitches.push_back(stitches_of(level.sewn.back()));
    }
    return level;
}

/// Every fine vertex from the coarse level: border points from their edge, so that both sides of a seam move
/// as one; inner points from the coarse triangle they lie in.
std::vector<Interpolation> prolong(const Pattern& pattern, const BorderPlan& plan, int level, const LevelBorders& coarse_borders,
                                   const FlatLevel& coarse, const LevelBorders& fine_borders,
                                   const FlatLevel& fine) {
    const int panels = int(coarse_borders.panels.size());
    auto first_point = [&](const FlatLevel& l, int p) {
        return int(std::lower_bound(l.panel_of_point.begin(), l.panel_of_point.end(), p) -
                   l.panel_of_point.begin());
    };
    std::vector<Interpolation> out(fine.points.size());
    for (int p = 0; p < panels; ++p) {
        if (pattern.panels[p].rest) { // the same points on every level
            for (int to = first_point(fine, p), from = first_point(coarse, p); to < first_point(fine, p + 1); ++to, ++from)
                out[to] = {{from, from, from}, {1, 0, 0}};
            continue;
        }
        const int begin = first_point(fine, p) + int(fine_borders.panels[p].points.size()),
                  end = first_point(fine, p + 1);
        const std::vector<Vec2> inner(fine.points.begin() + begin, fine.points.begin() + end);
        const std::vector<Interpolation> found = interpolate(coarse, p, inner);
        std::copy(found.begin(), found.end(), out.begin() + begin);
    }
    for (std::size_t i = 0; i < plan.intervals.size(); ++i) {
        const int p = plan.tracks[plan.intervals[i].track].panel;
        const int fine_first = first_point(fine, p), coarse_first = first_point(coarse, p);
        const int step =
            plan.count(plan.intervals[i].group, level + 1) / plan.count(plan.intervals[i].group, level);
        const auto along = [&](const std::vector<int>& to, const std::vector<int>& from) {
            for (int k = 0; k < int(to.size()); ++k) {
                const int a = coarse_first + from[k / step];
                const int b = coarse_first + from[std::min(k / step + 1, int(from.size()) - 1)];
                if (k % step == 0)
                    out[fine_first + to[k]] = {{a, a, a}, {1, 0, 0}};
                else
                    out[fine_first + to[k]] = {{a, b, b}, {0.5, 0.5, 0}};
            }
        };
        along(fine_borders.right_of[i], coarse_borders.right_of[i]);
        along(fine_borders.of_interval[i], coarse_borders.of_interval[i]);
    }
    return out;
}

void refuse_senseless(const Pattern& pattern, const TriangulateOptions& options) {
    if (!(options.edge_length > 1e-4 && options.edge_length < 100))
        throw std::invalid_argument("edge length " + std::to_string(options.edge_length) +
                                    " m is out of range, expected 0.0001 to 100 m");
    if (options.levels < 1 || options.levels > 8 || options.smoothing < 0)
        throw std::invalid_argument("triangulation takes 1 to 8 levels and 0 or more smoothing sweeps");
    if (options.grain_lattice && options.size)
        throw std::invalid_argument("a lattice along the grain has one edge length everywhere, but a size function was given");
    double area = 0;
    for (const Panel& panel : pattern.panels)
        area += std::abs(signed_area(panel.outline));
    const double triangles = area / (0.433 * options.edge_length * options.edge_length);
    if (!(triangles < 2e7))
        throw std::invalid_argument("an edge length of " + std::to_string(options.edge_length) +
                                    " m would cut " + std::to_string(area) + " m2 of cloth into " +
                                    std::to_string(triangles / 1e6) +
                                    " million triangles, expected at most 20 million");
}

} // namespace

FlatPattern triangulate(const Pattern& pattern, const TriangulateOptions& options) {
    refuse_senseless(pattern, options);
    BorderPlan plan = plan_borders(pattern, options);
    LeastCounts least(plan.levels, std::vector<int>(plan.groups.size(), 1));
    std::vector<LevelBorders> borders(plan.levels);
    for (bool changed = true; changed;) {
        changed = false;
        choose_counts(plan, options, least);
        for (int l = 0; l < plan.levels; ++l) {
            borders[l] = make_borders(pattern, plan, options, l);
            if (uncross(pattern, plan, borders[l], l, least)) changed = true;
            if (keep_open(plan, borders[l], l, least)) changed = true;
        }
    }
    FlatPattern flat;
    for (LevelBorders& b : borders) {
        std::vector<PlanarMesh> meshes = mesh_panels(pattern, b, options);
        split_chords(plan, b, meshes);
        b.right_of = b.of_interval;
        for (int p = 0; p < int(meshes.size()); ++p)
            open_panel(pattern, plan, p, meshes[p], b);
        flat.levels.push_back(assemble(pattern, plan, b, meshes));
    }
    for (int l = 0; l + 1 < plan.levels; ++l)
        flat.prolongation.push_back(
            prolong(pattern, plan, l, borders[l], flat.levels[l], borders[l + 1], flat.levels[l + 1]));
    return flat;
}

} // namespace toile
