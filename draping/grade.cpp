// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/grade.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace toile {

namespace {

constexpr double steepest = 0.5; // m of edge length per m of cloth

/// The angle by which an edge of two triangles is bent beyond rest; the sign does not matter here.
double bent_by(const Garment& g, const Points& x, int e) {
    std::array<Vec3, 2> normal;
    for (int k = 0; k < 2; ++k) {
        const Triangle n = g.nodes(g.edges.incident[g.edges.first[e] + k]);
        normal[k] = (x[n[1]] - x[n[0]]).cross(x[n[2]] - x[n[0]]).normalized();
    }
    const double angle = std::acos(std::clamp(normal[0].dot(normal[1]), -1.0, 1.0));
    return std::abs(angle - std::abs(g.rest.angles[e]));
}

} // namespace

std::vector<double> node_curvature(const Garment& g, const Points& x) {
    std::vector<double> sum(g.node_count, 0), weight(g.node_count, 0);
    for (int e = 0; e < g.edges.size(); ++e) {
        if (g.edges.triangles_at(e) != 2) continue;
        const auto [a, b] = g.edges.ends[e];
        double area = 0;
        for (int k = 0; k < 2; ++k) area += rest_area(g.rest.edges[g.edges.incident[g.edges.first[e] + k]]) / 3;
        const double length = (x[b] - x[a]).norm(), width = length > 0 ? 2 * area / length : 0;
        if (!(width > 0)) continue;
        const double curvature = bent_by(g, x, e) / width;
        for (const int i : {a, b}) {
            sum[i] += area * curvature * curvature;
            weight[i] += area;
        }
    }
    for (int i = 0; i < g.node_count; ++i) sum[i] = weight[i] > 0 ? std::sqrt(sum[i] / weight[i]) : 0;
    return sum;
}

std::vector<double> graded_edges(const Garment& g, const Points& x, const GradeOptions& o) {
    const std::vector<double> curvature = node_curvature(g, x), area = node_areas(g);
    std::vector<int> by_curvature(g.node_count);
    std::iota(by_curvature.begin(), by_curvature.end(), 0);
    std::stable_sort(by_curvature.begin(), by_curvature.end(), [&](int a, int b) { return curvature[a] > curvature[b]; });
    double left = o.curved * std::accumulate(area.begin(), area.end(), 0.0), most_curved = 0;
    for (const int i : by_curvature) {
        most_curved = curvature[i];
        if ((left -= area[i]) <= 0) break;
    }
    std::vector<double> edge(g.node_count);
    for (int i = 0; i < g.node_count; ++i)
        edge[i] = curvature[i] > 0 ? std::clamp(o.edge_length * std::sqrt(most_curved / curvature[i]), o.edge_length, o.most) : o.most;
    for (bool changed = true; changed;) {
        changed = false;
        for (const auto& [a, b] : g.edges.ends) {
            const double way = steepest * (x[b] - x[a]).norm();
            for (const auto& [i, j] : {std::pair(a, b), std::pair(b, a)})
                if (edge[i] > edge[j] + way * (1 + 1e-9)) edge[i] = edge[j] + way, changed = true;
        }
    }
    return edge;
}

std::function<double(int panel, const Vec2& at)> over_panels(const Garment& g, std::vector<double> of_node) {
    std::vector<FlatPanel> panels;
    for (int p = 0; p < int(g.panel_names.size()); ++p) panels.push_back(flat_panel(g, p));
    return [&g, panels = std::move(panels), of_node = std::move(of_node)](int panel, const Vec2& at) {
        const int t = nearest_triangle(g, panels[panel], at);
        const Triangle n = g.nodes(t);
        return shares_in_triangle(g, t, at).dot(Vec3(of_node[n[0]], of_node[n[1]], of_node[n[2]]));
    };
}

} // namespace toile
