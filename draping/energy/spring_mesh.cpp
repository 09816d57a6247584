// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/spring_mesh.h"

#include "draping/energy/bend.h"

#include <cmath>
#include <numbers>

namespace toile {

namespace {

/// An edge as one of its triangles has it in flat cloth.
struct FlatEdge {
    double length = 0; ///< m
    double angle = 0;  ///< rad from the warp
    double area = 0;   ///< m2, of the triangle
    int corner = 0;    ///< node opposite
    double foot = 0;   ///< where the foot of that corner lies, as a share of the way from end to end
    const Fabric* fabric = nullptr;
};

FlatEdge flat_edge(const Garment& g, const std::vector<Fabric>& fabrics, int e, int t) {
    int k = 0;
    while (g.edges.of_triangle[t][k] != e) ++k;
    const Triangle nodes = g.nodes(t);
    const Mat2& r = g.rest.edges[t];
    const std::array<Vec2, 3> at{Vec2::Zero(), r.col(0), r.col(1)};
    int a = (k + 1) % 3, b = (k + 2) % 3;
    if (nodes[a] != g.edges.ends[e][0]) std::swap(a, b);
    const Vec2 d = at[b] - at[a]; // (weft, warp)
    FlatEdge f;
    f.length = d.norm();
    f.angle = std::atan2(d.x(), d.y());
    f.area = rest_area(r);
    f.corner = nodes[k];
    f.foot = (at[k] - at[a]).dot(d) / d.squaredNorm();
    f.fabric = &fabrics[g.panel_of_triangle[t]];
    return f;
}

SpringKind kind_at(double angle) {
    const double c = std::abs(std::cos(angle)), s = std::abs(std::sin(angle));
    const double near = std::cos(std::numbers::pi / 8);
    return c > near ? SpringKind::warp : s > near ? SpringKind::weft : SpringKind::shear;
}

/// Along an edge with these triangles.
Spring edge_spring(const std::array<int, 2>& ends, const std::vector<FlatEdge>& sides, double beyond) {
    Spring s{ends[0], ends[1]};
    double area = 0;
    for (const FlatEdge& f : sides) {
        s.stiffness += strip_modulus(*f.fabric, f.angle) * f.area / (f.length * f.length);
        s.length += f.area * f.length;
        s.limit += f.area * strip_limit(*f.fabric, f.angle);
        area += f.area;
    }
    s.length /= area;
    s.limit /= area;
    s.kind = kind_at(sides[0].angle);
    s.stiffness_beyond = beyond * s.stiffness;
    if (s.limit > 0 && beyond > 1) s.threshold = s.limit * s.length;
    return s;
}

void add_hinge(std::vector<Spring>& springs, SpringBetween& between, const std::array<int, 2>& ends, const FlatEdge& c,
               const FlatEdge& d) {
    if (c.corner == d.corner) return; // a cone of two triangles
    const double length = 0.5 * (c.length + d.length), up = 2 * c.area / length, down = 2 * d.area / length;
    const double across = std::numbers::pi / 2;
    const double modulus = (c.area * bend_modulus(*c.fabric, c.angle + across) +
                            d.area * bend_modulus(*d.fabric, d.angle + across)) /
                           (c.area + d.area);
    brace(springs, between,
          {{ends[0], {0, 0}, -(1 - c.foot) / up - (1 - d.foot) / down},
           {ends[1], {length, 0}, -c.foot / up - d.foot / down},
           {c.corner, {c.foot * length, up}, 1 / up},
           {d.corner, {d.foot * length, -down}, 1 / down}},
          modulus * length * length / (c.area + d.area));
}

} // namespace

double strip_modulus(const Fabric& f, double angle) {
    const double c = std::pow(std::cos(angle), 2), s = std::pow(std::sin(angle), 2);
    return 1 / (c * c / f.stretch_warp + s * s / f.stretch_weft + (1 / f.shear - 2 * f.poisson / f.stretch_warp) * c * s);
}

double strip_limit(const Fabric& f, double angle) {
    if (f.limit_warp <= 0 || f.limit_weft <= 0 || f.limit_shear <= 0) return 0;
    const double c = std::cos(angle), s = std::sin(angle);
    return c * c * f.limit_warp + s * s * f.limit_weft + std::abs(c * s) * f.limit_shear;
}

std::vector<Spring> mesh_springs(const Garment& g, const std::vector<Fabric>& fabrics, const SpringMeshOptions& options) {
    std::vector<Spring> springs;
    SpringBetween between;
    std::vector<std::vector<FlatEdge>> sides(g.edges.size());
    for (int e = 0; e < g.edges.size(); ++e) {
        for (int i = g.edges.first[e]; i < g.edges.first[e + 1]; ++i) {
            const FlatEdge f = flat_edge(g, fabrics, e, g.edges.incident[i]);
            if (f.area > 0) sides[e].push_back(f);
        }
        if (sides[e].empty()) continue;
        between.emplace(g.edges.ends[e], int(springs.size()));
        springs.push_back(edge_spring(g.edges.ends[e], sides[e], options.beyond));
    }
    for (int e = 0; e < g.edges.size(); ++e)
        if (sides[e].size() == 2 && g.edges.triangles_at(e) == 2)
            add_hinge(springs, between, g.edges.ends[e], sides[e][0], sides[e][1]);
    damp(springs, options.damping_time);
    return springs;
}

} // namespace toile
