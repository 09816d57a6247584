// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/one_surface.h"

#include "geometry/solid.h"

#include <numeric>

namespace toile {

OneSurface one_surface(const Garment& garment, const Points& x) {
    OneSurface s;
    s.mesh = {x, node_triangles(garment)};
    s.node.resize(x.size());
    std::iota(s.node.begin(), s.node.end(), 0);
    s.joined = join_equal_points(s.mesh);
    // The ends of an edge without length are joined and their triangles dropped; the order of the others is kept.
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        const Triangle n = garment.nodes(t);
        if (x[n[0]] == x[n[1]] || x[n[1]] == x[n[2]] || x[n[2]] == x[n[0]]) continue;
        for (int k = 0; k < 3; ++k) s.node[n[k]] = s.mesh.triangles[s.triangle.size()][k];
        s.triangle.push_back(t);
    }
    s.stitches = garment.stitches;
    for (Stitch& stitch : s.stitches) {
        stitch.a = s.node[stitch.a];
        stitch.b = {s.node[stitch.b[0]], s.node[stitch.b[1]]};
    }
    return s;
}

} // namespace toile
