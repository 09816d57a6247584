// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/arrange.h"

namespace toile {

Points place(const Pattern& pattern, const FlatLevel& flat) {
    Points x(flat.points.size());
    for (std::size_t v = 0; v < x.size(); ++v) {
        const Placement& p = pattern.panels[flat.panel_of_point[v]].placement;
        x[v] = p.rotation * Vec3(flat.points[v].x(), flat.points[v].y(), 0) + p.translation;
    }
    return x;
}

} // namespace toile
