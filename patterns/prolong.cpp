// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/prolong.h"

#include "patterns/plane.h"

#include <algorithm>
#include <cmath>

namespace toile {
namespace {

/// Triangles of a panel, found by the square cell that a point lies in.
struct Cells {
    Vec2 low;
    double width = 1;
    int columns = 1, rows = 1;
    std::vector<std::vector<int>> triangles;

    int column(double x) const { return std::clamp(int(std::floor((x - low.x()) / width)), 0, columns - 1); }
    int row(double y) const { return std::clamp(int(std::floor((y - low.y()) / width)), 0, rows - 1); }
};

std::array<double, 3> barycentric(const FlatLevel& level, int t, const Vec2& p) {
    const Triangle& v = level.triangles[t];
    const Vec2 &a = level.points[v[0]], &b = level.points[v[1]], &c = level.points[v[2]];
    const double area = cross(b - a, c - a);
    const double wb = cross(p - a, c - a) / area, wc = cross(b - a, p - a) / area;
    return {1 - wb - wc, wb, wc};
}

Cells make_cells(const FlatLevel& level, const std::vector<int>& triangles) {
    Vec2 low = Vec2::Constant(1e300), high = Vec2::Constant(-1e300);
    for (int t : triangles)
        for (int v : level.triangles[t])
            low = low.cwiseMin(level.points[v]), high = high.cwiseMax(level.points[v]);
    Cells cells;
    cells.low = low;
    const Vec2 extent = high - low;
    cells.width = std::max(std::sqrt(extent.x() * extent.y() / triangles.size()), 1e-3 * extent.maxCoeff());
    cells.columns = int(extent.x() / cells.width) + 1;
    cells.rows = int(extent.y() / cells.width) + 1;
    cells.triangles.resize(std::size_t(cells.columns) * cells.rows);
    for (int t : triangles) {
        Vec2 a = Vec2::Constant(1e300), b = Vec2::Constant(-1e300);
        for (int v : level.triangles[t])
            a = a.cwiseMin(level.points[v]), b = b.cwiseMax(level.points[v]);
        for (int r = cells.row(a.y()); r <= cells.row(b.y()); ++r)
            for (int c = cells.column(a.x()); c <= cells.column(b.x()); ++c)
                cells.triangles[std::size_t(r) * cells.columns + c].push_back(t);
    }
    return cells;
}

double distance_to_triangle(const FlatLevel& level, int t, const Vec2& p) {
    double nearest = 1e300;
    for (int k = 0; k < 3; ++k)
        nearest = std::min(nearest, distance_to_segment(p, level.points[level.triangles[t][k]],
                                                        level.points[level.triangles[t][(k + 1) % 3]]));
    return nearest;
}

Interpolation cut_off(const Triangle& triangle, std::array<double, 3> weight) {
    double sum = 0;
    for (double& w : weight)
        sum += w = std::clamp(w, -0.25, 1.25);
    for (double& w : weight)
        w /= sum;
    return {triangle, weight};
}

} // namespace

std::vector<Interpolation> interpolate(const FlatLevel& coarse, int panel, const std::vector<Vec2>& queries) {
    std::vector<int> triangles;
    for (int t = 0; t < int(coarse.triangles.size()); ++t)
        if (coarse.panel_of_triangle[t] == panel) triangles.push_back(t);
    const Cells cells = make_cells(coarse, triangles);
    std::vector<Interpolation> out;
    for (const Vec2& p : queries) {
        int home = -1;
        for (int t : cells.triangles[std::size_t(cells.row(p.y())) * cells.columns + cells.column(p.x())]) {
            const std::array<double, 3> w = barycentric(coarse, t, p);
            if (*std::min_element(w.begin(), w.end()) < -1e-12) continue;
            home = t;
            break;
        }
        if (home < 0) { // beyond a curved border's chord: rare
            double best = 1e300;
            for (int t : triangles) {
                const double d = distance_to_triangle(coarse, t, p);
                if (d < best) best = d, home = t;
            }
        }
        out.push_back(cut_off(coarse.triangles[home], barycentric(coarse, home, p)));
    }
    return out;
}

} // namespace toile
