// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/arrange.h"

namespace toile {

Points place(const Pattern& pattern, const FlatLevel& flat) {
    Points x(flat.points.size());
    std::size_t first = 0; // point of the panel
    for (std::size_t v = 0; v < x.size(); ++v) {
        if (flat.panel_of_point[v] != flat.panel_of_point[first]) first = v;
        const Panel& panel = pattern.panels[flat.panel_of_point[v]];
        const Vec3 at = panel.rest ? panel.rest->mesh.points[v - first] : Vec3(flat.points[v].x(), flat.points[v].y(), 0);
        x[v] = panel.placement.rotation * at + panel.placement.translation;
    }
    return x;
}

} // namespace toile
