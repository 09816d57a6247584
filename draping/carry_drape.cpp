// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/carry_drape.h"

#include "draping/flat_places.h"

namespace toile {
namespace {

/// The triangle's plane, also beyond its corners.
Vec3 place_in(const Garment& g, const Points& x, int t, const Vec2& at) {
    const Vec2 weight = place_in_triangle(g, t, at);
    const Triangle n = g.nodes(t);
    const Vec3& o = x[n[0]];
    return o + weight.x() * (x[n[1]] - o) + weight.y() * (x[n[2]] - o);
}

} // namespace

bool can_carry(const Garment& from, int panel) { return !flat_panel(from, panel).triangles.empty(); }

Points carry_drape(const Garment& from, const Points& x, const Garment& to, const std::vector<int>& panel_of) {
    std::vector<FlatPanel> panels;
    for (const int p : panel_of) panels.push_back(flat_panel(from, p));
    Points out(to.node_count, Vec3::Zero());
    std::vector<int> count(to.node_count, 0);
    for (std::size_t v = 0; v < to.uv.size(); ++v) {
        const int t = nearest_triangle(from, panels[to.panel_of_vertex[v]], to.uv[v]);
        out[to.node_of_vertex[v]] += place_in(from, x, t, to.uv[v]);
        ++count[to.node_of_vertex[v]];
    }
    for (int n = 0; n < to.node_count; ++n)
        out[n] /= count[n];
    return out;
}

} // namespace toile
