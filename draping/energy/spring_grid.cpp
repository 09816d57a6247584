// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/spring_grid.h"

#include <cmath>
#include <stdexcept>

namespace toile {

namespace {

struct Maker {
    const SpringGrid& grid;
    std::vector<Spring> springs = {};
    SpringBetween between = {};

    int node(int i, int j) const { return i + grid.columns * j; }
    bool inside(int i, int j) const { return i >= 0 && j >= 0 && i < grid.columns && j < grid.rows; }

    /// From every node to the one (di, dj) on.
    void add(int di, int dj, double stiffness, SpringKind kind) {
        for (int j = 0; j < grid.rows; ++j)
            for (int i = 0; i < grid.columns; ++i) {
                if (!inside(i + di, j + dj)) continue;
                const int a = node(i, j), b = node(i + di, j + dj);
                Spring s{std::min(a, b), std::max(a, b), grid.spacing * std::hypot(di, dj)};
                s.stiffness = share(i, j, di, dj) * stiffness;
                s.kind = kind;
                between.emplace(std::array<int, 2>{s.a, s.b}, int(springs.size()));
                springs.push_back(s);
            }
    }

    /// Of the cloth along a line of the grid: half at a border.
    double share(int i, int j, int di, int dj) const {
        const bool border = (dj == 0 && (j == 0 || j == grid.rows - 1)) || (di == 0 && (i == 0 || i == grid.columns - 1));
        return border ? 0.5 : 1;
    }

    /// Over two edges.
    void bend(int di, int dj, double modulus) {
        if (modulus <= 0) return;
        const double h = grid.spacing;
        for (int j = 0; j < grid.rows; ++j)
            for (int i = 0; i < grid.columns; ++i)
                if (inside(i + 2 * di, j + 2 * dj))
                    brace(springs, between,
                          {{node(i, j), {0, 0}, 1 / h},
                           {node(i + di, j + dj), {h, 0}, -2 / h},
                           {node(i + 2 * di, j + 2 * dj), {2 * h, 0}, 1 / h}},
                          share(i, j, di, dj) * modulus);
    }
};

} // namespace

GridStiffness grid_stiffness(const Fabric& f, Diagonals diagonals) {
    GridStiffness k{f.stretch_warp, f.stretch_weft, f.shear, f.bend_warp, f.bend_weft};
    if (diagonals == Diagonals::one) {
        k.shear = 2 * f.shear;
        return k;
    }
    // Diagonals add the shear stiffness G to the moduli of both directions and to what couples them: those of strips are
    // then a - G^2 / b and b - G^2 / a, a and b with G in them.
    const double g = f.shear, ratio = f.stretch_weft / f.stretch_warp;
    const double b = 0.5 * (f.stretch_weft + std::sqrt(f.stretch_weft * f.stretch_weft + 4 * g * g * ratio)) / ratio;
    k.warp = b - g;
    k.weft = ratio * b - g;
    if (!(k.warp >= 0 && k.weft >= 0))
        throw std::invalid_argument("fabric " + f.name + ": no springs along warp and weft with both diagonals resist stretch "
                                    "that differs so much beside such a shear stiffness");
    return k;
}

std::vector<Spring> grid_springs(const SpringGrid& grid, const GridStiffness& k, Diagonals diagonals) {
    Maker m{grid};
    m.add(1, 0, k.weft, SpringKind::weft);
    m.add(0, 1, k.warp, SpringKind::warp);
    if (k.shear > 0) m.add(1, 1, k.shear, SpringKind::shear);
    if (k.shear > 0 && diagonals == Diagonals::both) m.add(-1, 1, k.shear, SpringKind::shear);
    m.bend(1, 0, k.bend_weft);
    m.bend(0, 1, k.bend_warp);
    return m.springs;
}

std::vector<double> grid_masses(const SpringGrid& grid, double density) {
    const auto width = [&](int i, int count) { return grid.spacing * (i == 0 || i == count - 1 ? 0.5 : 1); };
    std::vector<double> mass;
    for (int j = 0; j < grid.rows; ++j)
        for (int i = 0; i < grid.columns; ++i) mass.push_back(density * width(i, grid.columns) * width(j, grid.rows));
    return mass;
}

Points grid_points(const SpringGrid& grid) {
    Points x;
    for (int j = 0; j < grid.rows; ++j)
        for (int i = 0; i < grid.columns; ++i) x.push_back(grid.spacing * Vec3(i, j, 0));
    return x;
}

} // namespace toile
