// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/yarns.h"

#include "geometry/text.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace toile {

namespace {

constexpr double along = 0.035; // sine of two degrees
constexpr double eased = 0.02;  // difference of length between triangles at an edge

/// 0: along the weft, 1: along the warp, -1: along neither.
int direction_of(const Vec2& edge) {
    for (int c = 0; c < 2; ++c)
        if (std::abs(edge[1 - c]) <= along * edge.norm()) return c;
    return -1;
}

double elongation(const GrainImages& y, int c) { return 0.5 * (y.col(c).squaredNorm() - 1); }

double energy(const GrainTriangle& t, const GrainImages& y) {
    const double u = elongation(y, 0), v = elongation(y, 1), s = y.col(0).dot(y.col(1));
    return 0.5 * (t.weft * u * u + t.warp * v * v + t.shear * s * s);
}

GrainSlope slope(const GrainTriangle& t, const GrainImages& y) {
    const double s = t.shear * y.col(0).dot(y.col(1));
    GrainSlope g;
    g << t.weft * elongation(y, 0) * y.col(0) + s * y.col(1), t.warp * elongation(y, 1) * y.col(1) + s * y.col(0);
    return g;
}

GrainBend stiffness(const GrainTriangle& t, const GrainImages& y, HessianKind kind) {
    GrainSlope across;
    across << y.col(1), y.col(0);
    GrainBend h = t.shear * across * across.transpose();
    for (int c = 0; c < 2; ++c) {
        const double k = c == 0 ? t.weft : t.warp;
        double turning = elongation(y, c);
        if (kind == HessianKind::projected) turning = std::max(turning, 0.0);
        h.block<3, 3>(3 * c, 3 * c) += k * (y.col(c) * y.col(c).transpose() + turning * Mat3::Identity());
    }
    if (kind == HessianKind::exact) {
        const Mat3 turn = t.shear * y.col(0).dot(y.col(1)) * Mat3::Identity();
        h.block<3, 3>(0, 3) += turn;
        h.block<3, 3>(3, 0) += turn;
    }
    return h;
}

} // namespace

std::vector<LengthConstraint> yarn_edges(const Garment& g) {
    std::vector<LengthConstraint> yarns;
    std::vector<double> shortest(g.edges.size(), 1e300), longest(g.edges.size(), 0), sum(g.edges.size(), 0);
    std::vector<char> is_yarn(g.edges.size(), 0);
    for (std::size_t t = 0; t < g.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const int e = g.edges.of_triangle[t][k];
            const Vec2 edge = rest_edge(g.rest.edges[t], k);
            shortest[e] = std::min(shortest[e], edge.norm());
            longest[e] = std::max(longest[e], edge.norm());
            sum[e] += edge.norm();
            if (direction_of(edge) >= 0) is_yarn[e] = 1;
        }
    for (int e = 0; e < g.edges.size(); ++e)
        if (is_yarn[e] && longest[e] <= (1 + eased) * shortest[e])
            yarns.push_back({g.edges.ends[e][0], g.edges.ends[e][1], sum[e] / g.edges.triangles_at(e)});
    if (int(yarns.size()) >= 3 * g.node_count - 6)
        throw std::invalid_argument(text("%d edges are to keep their lengths, which leaves %d nodes no motion: expected fewer "
                                         "than three for every node, less six",
                                         int(yarns.size()), g.node_count));
    return yarns;
}

YarnCloth::YarnCloth(const Garment& g, const std::vector<Fabric>& fabrics, std::vector<LengthConstraint> yarns)
    : tension(std::move(yarns)), bending_(make_bending(g, fabrics)), creases_(make_creases(g, fabrics)) {
    std::set<std::array<int, 2>> kept;
    for (const LengthConstraint& c : tension.lines()) kept.insert({c.a, c.b});
    for (std::size_t t = 0; t < g.triangles.size(); ++t) {
        if (rest_area(g.rest.edges[t]) == 0) continue;
        GrainTriangle y = make_grain_triangle(g, fabrics[g.panel_of_triangle[t]], int(t));
        for (int k = 0; k < 3; ++k) {
            const int c = direction_of(rest_edge(g.rest.edges[t], k));
            if (c >= 0 && kept.count(g.edges.ends[g.edges.of_triangle[t][k]])) (c == 0 ? y.weft : y.warp) = 0;
        }
        triangles_.push_back(y);
    }
}

double YarnCloth::value(const Points& x) const {
    double sum = tension.value(x) + bend_value(bending_, x) + toile::value(creases_, x);
    for (const GrainTriangle& t : triangles_) sum += energy(t, grain_images(t.nodes, t.shape, x));
    return sum;
}

void YarnCloth::add_gradient(const Points& x, Eigen::VectorXd& g) const {
    tension.add_gradient(x, g);
    toile::add_gradient(bending_, x, g);
    toile::add_gradient(creases_, x, g);
    for (const GrainTriangle& t : triangles_) {
        const GrainSlope s = slope(t, grain_images(t.nodes, t.shape, x));
        for (int k = 0; k < 3; ++k)
            g.segment<3>(3 * t.nodes[k]) += at_corner(t.shape, s, k);
    }
}

void YarnCloth::couplings(std::vector<std::pair<int, int>>& pairs) const {
    tension.couplings(pairs);
    for (const GrainTriangle& t : triangles_)
        for (int k = 0; k < 3; ++k) pairs.emplace_back(t.nodes[k], t.nodes[(k + 1) % 3]);
    toile::couplings(bending_, pairs);
    toile::couplings(creases_, pairs);
}

void YarnCloth::add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const {
    tension.add_hessian(x, kind, h);
    toile::add_hessian(bending_, h);
    toile::add_hessian(creases_, x, kind, h);
    for (const GrainTriangle& t : triangles_)
        h.add_element(t.nodes, at_corners(t.shape, stiffness(t, grain_images(t.nodes, t.shape, x), kind)));
}

} // namespace toile
