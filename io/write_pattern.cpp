// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/write_pattern.h"

#include "io/json.h"

#include <cmath>
#include <stdexcept>

namespace toile {

namespace {

constexpr double units = 100; // per metre

Json point(const Vec2& p) { return {units * p.x(), units * p.y()}; }

/// A control point by its edge.
Json control(const Edge& e, const Vec2& p) {
    const Vec2 along = e.end - e.start, up(-along.y(), along.x()), d = p - e.start;
    return {d.dot(along) / along.squaredNorm(), d.dot(up) / along.squaredNorm()};
}

Json curve(const Edge& e) {
    if (const auto* q = std::get_if<Quadratic>(&e.curve)) return {{"type", "quadratic"}, {"params", {control(e, q->control)}}};
    if (const auto* k = std::get_if<Cubic>(&e.curve))
        return {{"type", "cubic"}, {"params", {control(e, k->control0), control(e, k->control1)}}};
    const Arc& a = std::get<Arc>(e.curve);
    return {{"type", "circle"}, {"params", {units * a.radius, a.large ? 1 : 0, a.right ? 1 : 0}}};
}

/// Degrees about x, y, z with z applied last.
Json angles(const Mat3& r) {
    const double y = std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0)));
    const bool locked = std::hypot(r(0, 0), r(1, 0)) < 1e-9;
    const double x = locked ? std::atan2(-r(1, 2), r(1, 1)) : std::atan2(r(2, 1), r(2, 2));
    const double z = locked ? 0 : std::atan2(r(1, 0), r(0, 0));
    const double degrees = 180 / EIGEN_PI;
    return {degrees * x, degrees * y, degrees * z};
}

Json panel_json(const Panel& panel) {
    if (!panel.holes.empty() || !panel.lines.empty() || panel.rest)
        throw std::invalid_argument("panel " + panel.name + " has holes, lines or a rest mesh, which a specification cannot say");
    const Vec3 t = units * panel.placement.translation;
    Json vertices = Json::array(), edges = Json::array();
    for (std::size_t i = 0; i < panel.outline.size(); ++i) {
        const Edge& e = panel.outline[i];
        vertices.push_back(point(e.start));
        Json& edge = edges.emplace_back(Json{{"endpoints", {i, (i + 1) % panel.outline.size()}}});
        if (!std::holds_alternative<Straight>(e.curve)) edge["curvature"] = curve(e);
        if (!e.label.empty()) edge["label"] = e.label;
    }
    return {{"translation", {t.x(), t.y(), t.z()}}, {"rotation", angles(panel.placement.rotation)}, {"vertices", vertices}, {"edges", edges}};
}

} // namespace

std::string pattern_text(const Pattern& pattern) {
    Json panels = Json::object(), stitches = Json::array();
    for (const Panel& panel : pattern.panels) panels[panel.name] = panel_json(panel);
    for (const Seam& seam : pattern.seams) {
        const EdgeSpan &a = seam.a.at(0), &b = seam.b.at(0);
        if (seam.a.size() != 1 || seam.b.size() != 1 || a.t0 != 0 || a.t1 != 1 || b.t0 != 1 || b.t1 != 0)
            throw std::invalid_argument(seam.name + " does not join one whole edge to another, end to start");
        stitches.push_back({{{"panel", pattern.panels[a.panel].name}, {"edge", a.edge}}, {{"panel", pattern.panels[b.panel].name}, {"edge", b.edge}}});
    }
    const Json properties{{"units_in_meter", units}, {"curvature_coords", "relative"}, {"normalize_panel_translation", false}, {"normalized_edge_loops", true}};
    return Json{{"pattern", {{"panels", panels}, {"stitches", stitches}}}, {"properties", properties}}.dump(1) + '\n';
}

} // namespace toile
