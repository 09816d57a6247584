// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A skirt of two panels as a straight tube: a garment with known shape for tests of files and pictures.

#include "sewing/garment.h"

#include <cmath>

namespace toile::test {

struct Skirt {
    Garment garment;
    Points x;
};

/// Front and back, each `columns` x `rows` cells, half of a circle of `radius` metres from `top` down by
/// `length`; closed seams at the sides, or open ones with a stitch per row.
inline Skirt make_skirt(int columns, int rows, double radius, double top, double length, bool closed = true) {
    Skirt s;
    Garment& g = s.garment;
    g.panel_names = {"front", "back"};
    g.panel_fabrics = {"", ""};
    g.panel_layers = {0, 0};
    const double width = EIGEN_PI * radius;
    for (int p = 0; p < 2; ++p)
        for (int j = 0; j <= rows; ++j)
            for (int i = 0; i <= columns; ++i) {
                const double u = double(i) / columns, v = double(j) / rows, angle = EIGEN_PI * (u + p);
                g.uv.emplace_back(width * u - width / 2, length * v);
                g.panel_of_vertex.push_back(p);
                s.x.emplace_back(-radius * std::cos(angle), top - length * (1 - v), radius * std::sin(angle));
            }
    const auto vertex = [&](int p, int i, int j) { return (p * (rows + 1) + j) * (columns + 1) + i; };
    for (int p = 0; p < 2; ++p)
        for (int j = 0; j < rows; ++j)
            for (int i = 0; i < columns; ++i) {
                const int a = vertex(p, i, j), b = vertex(p, i + 1, j), c = vertex(p, i + 1, j + 1),
                          d = vertex(p, i, j + 1);
                g.triangles.push_back({a, b, c});
                g.triangles.push_back({a, c, d});
                g.panel_of_triangle.insert(g.panel_of_triangle.end(), 2, p);
            }
    for (const Triangle& t : g.triangles) {
        Mat2 e;
        e << g.uv[std::size_t(t[1])] - g.uv[std::size_t(t[0])],
            g.uv[std::size_t(t[2])] - g.uv[std::size_t(t[0])];
        g.rest.edges.push_back(e);
    }
    std::vector<int> twin(g.uv.size(), -1);
    for (int j = 0; j <= rows; ++j) {
        twin[std::size_t(vertex(1, 0, j))] = vertex(0, columns, j);
        twin[std::size_t(vertex(1, columns, j))] = vertex(0, 0, j);
    }
    Points nodes;
    for (std::size_t v = 0; v < g.uv.size(); ++v) {
        const int t = closed ? twin[v] : -1;
        g.node_of_vertex.push_back(t < 0 ? int(nodes.size()) : g.node_of_vertex[std::size_t(t)]);
        if (t < 0) nodes.push_back(s.x[v]);
    }
    s.x = nodes;
    g.node_count = int(nodes.size());
    if (!closed)
        for (std::size_t v = 0; v < twin.size(); ++v)
            if (twin[v] >= 0) g.stitches.push_back({int(v), {twin[v], twin[v]}, 0, 0, length / rows});
    g.edges = make_edges(node_triangles(g), g.node_count);
    g.rest.angles.assign(std::size_t(g.edges.size()), 0.0);
    g.eased_triangle.assign(g.triangles.size(), false);
    std::vector<bool> side(std::size_t(g.node_count), false);
    for (std::size_t v = 0; v < twin.size(); ++v)
        if (twin[v] >= 0)
            for (const int w : {int(v), twin[v]})
                side[std::size_t(g.node_of_vertex[std::size_t(w)])] = true;
    for (const auto& [a, b] : g.edges.ends)
        g.seam_edge.push_back(side[std::size_t(a)] && side[std::size_t(b)]);
    return s;
}

} // namespace toile::test
