// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/resting_states.h"

#include "draping/cloth.h"
#include "draping/rest/moulded.h"
#include "draping/solve/settle.h"
#include "sewing/mesh_grain.h"

namespace toile {

Garment moulded_cloth(const std::vector<Triangle>& triangles, const Points& x, const Points& warp) {
    std::vector<Mat2> edges;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const Triangle& n = triangles[t];
        edges.push_back(edges_in_grain(x[n[1]] - x[n[0]], x[n[2]] - x[n[0]], warp[t]));
    }
    Garment g = mesh_garment(triangles, int(x.size()), std::move(edges));
    g.rest = moulded(g, x);
    return g;
}

RestingStates resting_states(const Garment& garment, const Fabric& fabric, const Points& start, const RestingOptions& options) {
    const PanelFabrics fabrics(garment.panel_names.size(), fabric);
    RestingStates states;
    const auto settled = [&](const Points& x) {
        Sheet sheet = make_sheet(garment, fabrics);
        sheet.limits.clear();
        FreeCloth cloth(std::make_unique<SheetEnergy>(std::move(sheet)), node_masses(garment, fabrics));
        Cholesky factor;
        SettleOptions how;
        how.tolerance = options.tolerance;
        how.max_iterations = options.max_iterations;
        NearestShape shape;
        shape.x = x;
        const SettleResult r = settle(cloth, shape.x, factor, how);
        shape.energy = r.energy;
        shape.gradient = r.residual;
        shape.iterations = r.iterations;
        shape.end = r.end == SettleEnd::settled ? NearestEnd::minimum : NearestEnd::stalled;
        ++states.starts;
        states.unsettled += r.end != SettleEnd::settled;
        return shape;
    };
    Prescribed as_told = measured(node_triangles(garment), start);
    weigh(as_told, fabric);
    states.found = distinct_shapes(as_told, start, settled);
    return states;
}

} // namespace toile
