// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/wait.h"

#include "draping/place.h"
#include "geometry/disjoint_sets.h"

#include <algorithm>

namespace toile {

namespace {

/// Marks panels that hang by nothing but panels which are marked: parts of the garment, once these are gone, without
/// a labelled border.
void mark_what_hangs(const Garment& g, std::vector<bool>& marked) {
    const auto panel = [&](int node) { return g.panel_of_vertex[node]; }; // nodes of an open garment are its vertices
    DisjointSets parts(int(marked.size()));
    for (const Stitch& s : g.stitches)
        if (!marked[panel(s.a)] && !marked[panel(s.b[0])]) parts.join(panel(s.a), panel(s.b[0]));
    std::vector<bool> carried(marked.size(), false);
    for (const BorderLine& b : g.borders)
        if (!b.label.empty() && !marked[b.panel]) carried[parts.find(b.panel)] = true;
    if (std::find(carried.begin(), carried.end(), true) == carried.end()) return;
    for (int p = 0; p < int(marked.size()); ++p) marked[p] = marked[p] || !carried[parts.find(p)];
}

} // namespace

Waiting what_waits(const Garment& garment, const Points& x, const TriMesh& body, double closed) {
    const int panels = int(garment.panel_names.size());
    const std::vector<char> through = seams_through_body(garment, x, body);
    const auto ends = [&](const Stitch& s) {
        return std::pair(garment.panel_of_vertex[s.a], garment.panel_of_vertex[s.b[0]]);
    };
    Waiting w{std::vector<char>(through.size(), 0), std::vector<bool>(panels, false)};
    for (const Stitch& s : garment.stitches)
        if (through[s.seam] && stitch_gap(s, x) > closed) {
            w.seams[s.seam] = 1;
            w.outside[ends(s).first] = w.outside[ends(s).second] = true;
        }
    const auto count = std::size_t(std::count(w.seams.begin(), w.seams.end(), 1));
    if (count == 0 || count == w.seams.size()) return {};

    // Sides that wait for each other, such as front and back, and what hangs by each.
    DisjointSets joined(panels);
    for (const Stitch& s : garment.stitches) {
        const auto [a, b] = ends(s);
        if (!w.seams[s.seam] && w.outside[a] && w.outside[b]) joined.join(a, b);
    }
    std::vector<int> side(panels, -1);
    for (int p = 0; p < panels; ++p)
        if (w.outside[p]) side[p] = joined.find(p);
    mark_what_hangs(garment, w.outside);
    for (bool more = true; more;) {
        more = false;
        const std::vector<int> nearer = side;
        for (const Stitch& s : garment.stitches)
            for (const auto& [from, to] : {ends(s), std::pair(ends(s).second, ends(s).first)}) {
                if (!w.outside[to] || side[to] >= 0 || nearer[from] < 0) continue;
                side[to] = nearer[from];
                more = true;
            }
    }
    for (const Stitch& s : garment.stitches) {
        const auto [a, b] = ends(s);
        if (w.outside[a] && w.outside[b] && side[a] != side[b]) w.seams[s.seam] = 1;
    }
    return w;
}

} // namespace toile
