// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/pieces.h"

#include "geometry/disjoint_sets.h"

#include <algorithm>

namespace toile {

namespace {

/// Numbers in the order of their first panels.
std::vector<int> pieces_of_panels(const Garment& g) {
    DisjointSets together(int(g.panel_names.size()));
    std::vector<int> first(g.node_count, -1);
    for (std::size_t v = 0; v < g.node_of_vertex.size(); ++v) {
        int& other = first[g.node_of_vertex[v]];
        if (other < 0) other = g.panel_of_vertex[v];
        together.join(other, g.panel_of_vertex[v]);
    }
    const std::vector<int> root = together.all();
    std::vector<int> number(root.size());
    int count = 0;
    for (int i = 0; i < int(root.size()); ++i)
        number[i] = root[i] == i ? count++ : number[root[i]];
    return number;
}

} // namespace

std::vector<Piece> pieces_of(const Garment& g, const Points& x) {
    std::vector<Piece> pieces;
    const std::vector<int> piece_of = pieces_of_panels(g);
    for (int i = 0; i < int(piece_of.size()); ++i) {
        if (piece_of[i] == int(pieces.size())) pieces.emplace_back();
        pieces[piece_of[i]].panels.push_back(i);
    }
    for (int t = 0; t < int(g.triangles.size()); ++t)
        pieces[piece_of[g.panel_of_triangle[t]]].triangles.push_back(t);
    for (Piece& piece : pieces) {
        for (int t : piece.triangles) {
            const Triangle c = g.nodes(t);
            const Vec3 n = 0.5 * (x[c[1]] - x[c[0]]).cross(x[c[2]] - x[c[0]]);
            piece.normal += n;
            piece.middle += n.norm() * (x[c[0]] + x[c[1]] + x[c[2]]) / 3;
            piece.area += n.norm();
            piece.nodes.insert(piece.nodes.end(), c.begin(), c.end());
        }
        if (piece.area > 0) {
            piece.middle /= piece.area;
            piece.flatness = piece.normal.norm() / piece.area;
        }
        if (piece.normal.norm() > 0) piece.normal.normalize();
        std::sort(piece.nodes.begin(), piece.nodes.end());
        piece.nodes.erase(std::unique(piece.nodes.begin(), piece.nodes.end()), piece.nodes.end());
    }
    return pieces;
}

bool any_of_panels(const Piece& piece, const std::vector<bool>& marked) {
    return !marked.empty() &&
           std::any_of(piece.panels.begin(), piece.panels.end(), [&](int i) { return bool(marked[i]); });
}

} // namespace toile
