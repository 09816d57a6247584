// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Square panels in space and seams between them.

#include "sewing/garment.h"

#include <string>

namespace toile::test {

struct Cloth {
    Garment garment;
    Points x;
};

constexpr int square_cells = 10; ///< along a side of 20 cm

/// Adds a square panel of 20 cm about `middle`, spanned by u and v; its front looks along u x v.
inline void add_panel(Cloth& c, const Vec3& middle, const Vec3& u, const Vec3& v, int layer = 0) {
    constexpr int n = square_cells;
    Garment& g = c.garment;
    const int panel = int(g.panel_names.size()), first = g.node_count;
    g.panel_names.push_back("panel " + std::to_string(panel));
    g.panel_layers.push_back(layer);
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const Vec2 at(0.02 * i - 0.1, 0.02 * j - 0.1);
            g.uv.push_back(at);
            g.panel_of_vertex.push_back(panel);
            g.node_of_vertex.push_back(g.node_count++);
            c.x.push_back(middle + at.x() * u + at.y() * v);
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int a = first + j * (n + 1) + i, b = a + n + 1;
            g.triangles.insert(g.triangles.end(), {{a, a + 1, b + 1}, {a, b + 1, b}});
            g.panel_of_triangle.insert(g.panel_of_triangle.end(), 2, panel);
        }
    g.edges = make_edges(node_triangles(g), g.node_count);
}

/// Looks to the front, and to the back.
inline void add_front(Cloth& c, const Vec3& middle, int layer = 0) {
    add_panel(c, middle, Vec3::UnitX(), Vec3::UnitY(), layer);
}
inline void add_back(Cloth& c, const Vec3& middle, int layer = 0) {
    add_panel(c, middle, -Vec3::UnitX(), Vec3::UnitY(), layer);
}

/// Node of the square `panel` at column i and row j.
inline int square_node(int panel, int i, int j) {
    return (panel * (square_cells + 1) + j) * (square_cells + 1) + i;
}

inline void stitch(Cloth& c, int a, int b) { c.garment.stitches.push_back({a, {b, b}, 0, 0, 0.02}); }

/// Both sides of a front to those of a back.
inline void sew_sides(Cloth& c, int front, int back) {
    for (int j = 0; j <= square_cells; ++j) {
        stitch(c, square_node(front, 0, j), square_node(back, square_cells, j));
        stitch(c, square_node(front, square_cells, j), square_node(back, 0, j));
    }
}

/// The lower side of a square to the upper one of another that looks the same way.
inline void sew_below(Cloth& c, int upper, int lower) {
    for (int i = 0; i <= square_cells; ++i) stitch(c, square_node(upper, i, 0), square_node(lower, i, square_cells));
}

} // namespace toile::test
