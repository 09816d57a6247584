// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/landmarks.h"

#include "draping/hooks.h"
#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "geometry/slice.h"
#include "geometry/text.h"
#include "sewing/avatar.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

namespace toile {

namespace {

constexpr double most_off = 0.03; // m
constexpr double crest = 3e-3;    // m, of a shoulder: the middle of its uppermost part is the ridge

bool is_collar(const std::string& label) {
    return label.find("collar") != std::string::npos;
}

/// Whether an edge of this label is an open border of the sewn garment.
bool is_open(const Garment& sewn, const std::string& label) {
    std::set<std::array<int, 2>> labelled;
    for (const BorderLine& line : sewn.borders)
        for (std::size_t k = 0; line.label == label && k + 1 < line.vertices.size(); ++k) {
            const auto [low, high] =
                std::minmax(sewn.node_of_vertex[line.vertices[k]], sewn.node_of_vertex[line.vertices[k + 1]]);
            labelled.insert({low, high});
        }
    for (int e = 0; e < sewn.edges.size(); ++e)
        if (sewn.edges.triangles_at(e) == 1 && !sewn.seam_edge[e] && labelled.count(sewn.edges.ends[e]))
            return true;
    return false;
}

/// The highest vertex of the label's edges on a panel, and the highest of the other side of the axis if the
/// edges reach as far to it.
std::vector<int> tops(const StagedLevel& staged, const std::string& label, int panel, double axis) {
    const Garment& g = staged.garment;
    const auto at = [&](int v) { return staged.placed[g.node_of_vertex[v]]; };
    int top[2] = {-1, -1};
    for (const BorderLine& line : g.borders)
        for (int v : line.vertices) {
            if (line.label != label || line.panel != panel) continue;
            int& highest = top[at(v).x() > axis];
            if (highest < 0 || at(v).y() > at(highest).y()) highest = v;
        }
    std::vector<int> found;
    const auto reach = [&](int v) { return v < 0 ? 0 : std::abs(at(v).x() - axis); };
    for (int side : {0, 1})
        if (top[side] >= 0 && 2 * reach(top[side]) >= reach(top[1 - side])) found.push_back(top[side]);
    return found;
}

/// Nodes of the edges of each collar.
std::map<std::string, std::vector<int>> collar_nodes(const Garment& sewn) {
    std::map<std::string, std::set<int>> nodes;
    for (const BorderLine& line : sewn.borders)
        for (int v : line.vertices)
            if (is_collar(line.label)) nodes[line.label].insert(sewn.node_of_vertex[v]);
    std::map<std::string, std::vector<int>> sorted;
    for (const auto& [label, set] : nodes)
        sorted[label].assign(set.begin(), set.end());
    return sorted;
}

double mean_distance(const std::vector<int>& nodes, const Points& x, const TriMesh& body, const Bvh& tree) {
    double sum = 0;
    for (int node : nodes) {
        double squared = std::numeric_limits<double>::infinity();
        tree.nearest(x[node], squared, [&](int t) {
            const auto& [a, b, c] = body.triangles[t];
            return nearest_point_triangle(x[node], body.points[a], body.points[b], body.points[c]).squared;
        });
        sum += std::sqrt(squared);
    }
    return sum / double(nodes.size());
}

bool hull_contains(const std::vector<Vec2>& points, const Vec2& p) {
    const std::vector<Vec2> hull = convex_hull(points);
    for (std::size_t k = 0; k < hull.size(); ++k) {
        const Vec2 side = hull[(k + 1) % hull.size()] - hull[k], to = p - hull[k];
        if (side.x() * to.y() - side.y() * to.x() < 0) return false;
    }
    return hull.size() > 2;
}

} // namespace

const char* to_string(Belongs belongs) {
    switch (belongs) {
    case Belongs::file_height:
        return "file height";
    case Belongs::neck:
        return "neck";
    case Belongs::carried:
        return "carried";
    case Belongs::anywhere:
        return "anywhere";
    }
    return "anywhere";
}

std::optional<Vec3> shoulder_ridge(const TriMesh& body, double x, double height) {
    TriMesh lying = body; // its horizontal sections are the upright ones that run from front to back
    for (Vec3& p : lying.points)
        std::swap(p.x(), p.y());
    const auto loops = slice(lying, x); // of points (y, z)
    // The depths at which the section lies between two heights.
    const auto depths = [&](double low, double high) {
        Eigen::AlignedBox2d box;
        for (const std::vector<Vec2>& loop : loops)
            for (std::size_t k = 0; k < loop.size(); ++k) {
                Vec2 a = loop[k], b = loop[(k + 1) % loop.size()];
                if (a.x() > b.x()) std::swap(a, b);
                if (a.x() > high || b.x() < low) continue;
                const auto at = [&](double y) {
                    return a.x() < b.x() ? Vec2(a + (y - a.x()) / (b.x() - a.x()) * (b - a)) : a;
                };
                box.extend(a.x() < low ? at(low) : a);
                box.extend(b.x() > high ? at(high) : b);
            }
        return box;
    };
    const Eigen::AlignedBox2d below = depths(-std::numeric_limits<double>::max(), height);
    if (below.isEmpty()) return std::nullopt;
    const double top = below.max().x();
    return Vec3(x, top, depths(top - crest, top).center().y());
}

Neckline find_neckline(const StagedLevel& staged, const Garment& sewn, const Points& x, const TriMesh& body) {
    Neckline neckline;
    const auto nodes = collar_nodes(sewn);
    if (nodes.empty()) return neckline;
    double neck_y = 0;
    try {
        neck_y = measure_body(body).neck_y;
    } catch (const std::invalid_argument&) {
        return neckline; // no person's shape
    }
    LoopArea neck;
    for (const std::vector<Vec2>& loop : slice(body, neck_y))
        if (const LoopArea l = loop_area(loop); l.area > neck.area) neck = l;
    neckline.found = true;
    neckline.axis = neck.centroid;

    const Bvh tree(triangle_boxes(body.points, body.triangles, 0));
    std::vector<Vec2> seen;
    for (const auto& [label, all] : nodes) {
        neckline.from_body[label] = mean_distance(all, x, body, tree);
        for (int node : all)
            seen.emplace_back(x[node].x(), x[node].z());
        for (int panel = 0; panel < int(sewn.panel_names.size()); ++panel)
            for (int v : tops(staged, label, panel, neckline.axis.x()))
                if (const auto place =
                        shoulder_ridge(body, staged.placed[staged.garment.node_of_vertex[v]].x(), neck_y))
                    neckline.points.push_back({label, sewn.node_of_vertex[v], *place});
    }
    neckline.round_neck = hull_contains(seen, neckline.axis);
    return neckline;
}

std::vector<Landmark> find_landmarks(const StagedLevel& staged, const Garment& sewn, const Points& x,
                                     const Neckline& neckline) {
    const std::vector<std::string> labels = labels_of(sewn);
    const std::map<std::string, double> placed = label_heights(staged.garment, staged.placed, labels);
    std::vector<Landmark> landmarks;
    for (const auto& [label, settled] : label_heights(sewn, x, labels)) {
        Landmark l{label, placed.at(label), settled};
        if (carries(label)) {
            l.belongs = is_open(sewn, label) ? Belongs::file_height : Belongs::carried;
            if (l.belongs == Belongs::file_height) l.off = std::abs(l.settled - l.placed);
        } else if (is_collar(label)) {
            l.belongs = Belongs::neck;
            if (neckline.found) l.off = neckline.from_body.at(label);
            for (const NeckPoint& p : neckline.points)
                if (p.label == label) l.off = std::max(*l.off, (x[p.node] - p.place).norm());
        }
        landmarks.push_back(l);
    }
    return landmarks;
}

std::vector<std::string> misplaced(const std::vector<Landmark>& landmarks, const Neckline& neckline) {
    std::vector<std::string> sentences;
    for (const Landmark& l : landmarks)
        if (l.off && *l.off > most_off)
            sentences.push_back(
                text("the edges labelled \"%s\" lie %.1f cm from ", l.label.c_str(), 100 * *l.off) +
                (l.belongs == Belongs::neck ? "their place at the neck" : "their height in the file"));
    if (neckline.found && !neckline.round_neck)
        sentences.push_back("the neckline does not go round the neck");
    return sentences;
}

} // namespace toile
