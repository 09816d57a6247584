// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fit/moving_flat.h"

#include "patterns/curve.h"
#include "patterns/plane.h"
#include "sewing/sparse_solve.h"

#include <algorithm>
#include <map>

namespace toile {

namespace {

double area_of(const Triangle& t, const std::vector<Vec2>& at) {
    return 0.5 * cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]);
}

/// Points of a panel that are told where to lie: on its outline, on other borders of its cloth, on inner lines.
std::vector<char> told_points(const FlatLevel& level, int panel) {
    std::vector<char> told(level.points.size(), 0);
    const auto tell = [&](const std::vector<std::vector<int>>& lines) {
        for (const std::vector<int>& line : lines)
            for (const int v : line) told[v] = 1;
    };
    tell(level.border[panel]);
    tell(level.lines[panel]);
    std::map<std::array<int, 2>, int> sides;
    for (std::size_t t = 0; t < level.triangles.size(); ++t)
        if (level.panel_of_triangle[t] == panel)
            for (int k = 0; k < 3; ++k) {
                const auto [a, b] = std::minmax(level.triangles[t][k], level.triangles[t][(k + 1) % 3]);
                ++sides[{a, b}];
            }
    for (const auto& [ends, count] : sides)
        if (count == 1) told[ends[0]] = told[ends[1]] = 1;
    return told;
}

MovingPanel moving_panel(const FlatLevel& level, int panel) {
    MovingPanel m;
    m.panel = panel;
    const std::vector<char> told = told_points(level, panel);
    std::vector<int> number(level.points.size(), -1);
    for (int v = 0; v < int(level.points.size()); ++v) {
        if (level.panel_of_point[v] != panel) continue;
        std::vector<int>& list = told[v] ? m.border : m.inside;
        number[v] = int(list.size());
        list.push_back(v);
    }
    if (m.inside.empty()) return m;
    std::vector<Eigen::Triplet<double>> among;
    Eigen::MatrixXd toward = Eigen::MatrixXd::Zero(Eigen::Index(m.inside.size()), Eigen::Index(m.border.size()));
    for (std::size_t t = 0; t < level.triangles.size(); ++t) {
        if (level.panel_of_triangle[t] != panel) continue;
        const Triangle& v = level.triangles[t];
        for (int k = 0; k < 3; ++k) {
            const int a = v[(k + 1) % 3], b = v[(k + 2) % 3];
            const Vec2 p = level.points[a] - level.points[v[k]], q = level.points[b] - level.points[v[k]];
            const double w = 0.5 * p.dot(q) / std::abs(cross(p, q));
            for (const auto& [i, j] : {std::array{a, b}, std::array{b, a}}) {
                if (told[i]) continue;
                among.emplace_back(number[i], number[i], w);
                if (told[j])
                    toward(number[i], number[j]) += w;
                else
                    among.emplace_back(number[i], number[j], -w);
            }
        }
    }
    Eigen::SparseMatrix<double> laplacian(Eigen::Index(m.inside.size()), Eigen::Index(m.inside.size()));
    laplacian.setFromTriplets(among.begin(), among.end());
    m.weight = solve_definite(laplacian, toward);
    return m;
}

bool is_moved(const std::vector<Alteration>& alterations, int panel) {
    for (const Alteration& a : alterations)
        for (const OutlineMove& m : a.moves)
            if (m.point.panel == panel) return true;
    return false;
}

} // namespace

MovingFlat moving_flat(Pattern drawn, FlatPattern flat, std::vector<Alteration> alterations) {
    MovingFlat moving{std::move(drawn), std::move(flat), std::move(alterations), {}};
    for (const FlatLevel& level : moving.flat.levels) {
        moving.panels.emplace_back();
        for (int p = 0; p < int(moving.drawn.panels.size()); ++p)
            if (is_moved(moving.alterations, p)) moving.panels.back().push_back(moving_panel(level, p));
    }
    return moving;
}

std::vector<Vec2> moved_points(const MovingFlat& moving, const Pattern& pattern, int level) {
    const FlatLevel& flat = moving.flat.levels[level];
    std::vector<Vec2> points = flat.points;
    for (const MovingPanel& m : moving.panels[level]) {
        for (std::size_t e = 0; e < flat.border[m.panel].size(); ++e) {
            const Edge& before = moving.drawn.panels[m.panel].outline[e];
            const Edge& now = pattern.panels[m.panel].outline[e];
            const std::vector<int>& line = flat.border[m.panel][e];
            // By differences, so that amounts of 0 leave every bit as it is.
            const std::vector<Vec2> from = points_at(before, flat.border_at[m.panel][e]);
            const std::vector<Vec2> to = points_at(now, flat.border_at[m.panel][e]);
            for (std::size_t k = 0; k < line.size(); ++k) points[line[k]] = flat.points[line[k]] + (to[k] - from[k]);
        }
        if (m.inside.empty()) continue;
        Eigen::MatrixX2d shift(Eigen::Index(m.border.size()), 2);
        for (std::size_t k = 0; k < m.border.size(); ++k)
            shift.row(Eigen::Index(k)) = points[m.border[k]] - flat.points[m.border[k]];
        const Eigen::MatrixX2d inside = m.weight * shift;
        for (std::size_t k = 0; k < m.inside.size(); ++k) points[m.inside[k]] += inside.row(Eigen::Index(k)).transpose();
    }
    return points;
}

FlatPattern moved_flat(const MovingFlat& moving, const Pattern& pattern) {
    FlatPattern flat = moving.flat;
    for (int l = 0; l < int(flat.levels.size()); ++l) flat.levels[l].points = moved_points(moving, pattern, l);
    return flat;
}

int collapsed_triangle(const MovingFlat& moving, const std::vector<Vec2>& points, int level, double least) {
    const FlatLevel& flat = moving.flat.levels[level];
    for (std::size_t t = 0; t < flat.triangles.size(); ++t)
        if (!(area_of(flat.triangles[t], points) / area_of(flat.triangles[t], flat.points) >= least)) return int(t);
    return -1;
}

} // namespace toile
