// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/rest/prescribed.h"

#include "geometry/text.h"

#include <algorithm>
#include <stdexcept>

namespace toile {

namespace {

/// Of a triangle with these lengths (Heron), m2; not a number where there is none.
double area_of(double a, double b, double c) {
    const double s = (a + b + c) / 2;
    return std::sqrt(s * (s - a) * (s - b) * (s - c));
}

double area_of(const Prescribed& data, int t) {
    const auto& e = data.edges.of_triangle[t];
    return area_of(data.length[e[0]], data.length[e[1]], data.length[e[2]]);
}

std::vector<Spring> springs_of(const Prescribed& data) {
    std::vector<Spring> springs;
    for (int e = 0; e < data.edges.size(); ++e) {
        Spring s;
        s.a = data.edges.ends[e][0];
        s.b = data.edges.ends[e][1];
        s.length = data.length[e];
        s.stiffness = 2 * data.length_weight[e] / (s.length * s.length);
        springs.push_back(s);
    }
    return springs;
}

} // namespace

Prescribed measured(const std::vector<Triangle>& triangles, const Points& points) {
    Prescribed data;
    data.triangles = triangles;
    data.point_count = int(points.size());
    data.edges = make_edges(triangles, data.point_count);
    for (const Triangle& t : triangles)
        if (!((points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).norm() > 0))
            throw std::invalid_argument(text("the triangle of points %d, %d and %d has no area", t[0] + 1, t[1] + 1, t[2] + 1));
    for (const auto& [a, b] : data.edges.ends) data.length.push_back((points[b] - points[a]).norm());
    data.angle.assign(data.edges.size(), 0.0);
    for (const Hinge& h : hinges_of(data.edges, triangles)) data.angle[h.edge] = hinge_angle(h.nodes, points).value;
    data.length_weight.assign(data.edges.size(), 1.0);
    data.angle_weight = data.length_weight;
    return data;
}

void weigh(Prescribed& data, const Fabric& fabric) {
    const double stretch = (fabric.stretch_warp + fabric.stretch_weft) / 2;
    const double bend = (fabric.bend_warp + fabric.bend_weft) / 2;
    for (int e = 0; e < data.edges.size(); ++e) {
        double area = 0;
        for (int k = data.edges.first[e]; k < data.edges.first[e + 1]; ++k) area += area_of(data, data.edges.incident[k]);
        data.length_weight[e] = stretch / 2 * area / 3;
        const double altitude = area / data.length[e]; // the mean of both sides
        data.angle_weight[e] = bend / 2 * area / (altitude * altitude);
    }
}

int impossible_triangle(const Prescribed& data) {
    for (int t = 0; t < int(data.triangles.size()); ++t)
        if (!(area_of(data, t) > 0)) return t;
    return -1;
}

PrescribedEnergy::PrescribedEnergy(const Prescribed& data) : lengths_(springs_of(data)) {
    for (const Hinge& h : hinges_of(data.edges, data.triangles))
        angles_.push_back({h.nodes, data.angle[h.edge], 2 * data.angle_weight[h.edge]});
}

double PrescribedEnergy::value(const Points& x) const { return lengths_.value(x) + toile::value(angles_, x); }

void PrescribedEnergy::add_gradient(const Points& x, Eigen::VectorXd& g) const {
    lengths_.add_gradient(x, g);
    toile::add_gradient(angles_, x, g);
}

void PrescribedEnergy::couplings(std::vector<std::pair<int, int>>& pairs) const {
    lengths_.couplings(pairs);
    toile::couplings(angles_, pairs);
}

void PrescribedEnergy::add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const {
    lengths_.add_hessian(x, kind, h);
    toile::add_hessian(angles_, x, kind, h);
}

} // namespace toile
