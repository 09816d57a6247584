// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/yarns.h"

#include "geometry/text.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace toile {

namespace {

constexpr double along = 0.035; // sine of two degrees
constexpr double eased = 0.02;  // difference of length between triangles at an edge

using Images = Eigen::Matrix<double, 3, 2>; // of the unit directions of weft and warp
using Slope = Eigen::Matrix<double, 6, 1>;  // by the weft's image, then by the warp's
using Stiffness = Eigen::Matrix<double, 6, 6>;

/// Edge k of triangle t, opposite corner k, in flat cloth: (weft, warp).
Vec2 flat_edge(const Garment& g, int t, int k) {
    const Mat2& r = g.rest.edges[t];
    return k == 0 ? Vec2(r.col(1) - r.col(0)) : Vec2(r.col(k == 1 ? 1 : 0));
}

/// 0: along the weft, 1: along the warp, -1: along neither.
int direction_of(const Vec2& edge) {
    for (int c = 0; c < 2; ++c)
        if (std::abs(edge[1 - c]) <= along * edge.norm()) return c;
    return -1;
}

Images images(const GrainTriangle& t, const Points& x) {
    Eigen::Matrix<double, 3, 2> edges;
    edges << x[t.nodes[1]] - x[t.nodes[0]], x[t.nodes[2]] - x[t.nodes[0]];
    return edges * t.shape.bottomRows<2>();
}

double elongation(const Images& y, int c) { return 0.5 * (y.col(c).squaredNorm() - 1); }

double energy(const GrainTriangle& t, const Images& y) {
    const double u = elongation(y, 0), v = elongation(y, 1), s = y.col(0).dot(y.col(1));
    return 0.5 * (t.weft * u * u + t.warp * v * v + t.shear * s * s);
}

Slope slope(const GrainTriangle& t, const Images& y) {
    const double s = t.shear * y.col(0).dot(y.col(1));
    Slope g;
    g << t.weft * elongation(y, 0) * y.col(0) + s * y.col(1), t.warp * elongation(y, 1) * y.col(1) + s * y.col(0);
    return g;
}

Stiffness stiffness(const GrainTriangle& t, const Images& y, HessianKind kind) {
    Slope across;
    across << y.col(1), y.col(0);
    Stiffness h = t.shear * across * across.transpose();
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
            const Vec2 edge = flat_edge(g, int(t), k);
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
    : tension(std::move(yarns)), bending_(make_bending(g, fabrics)) {
    std::set<std::array<int, 2>> kept;
    for (const LengthConstraint& c : tension.lines()) kept.insert({c.a, c.b});
    for (std::size_t t = 0; t < g.triangles.size(); ++t) {
        const Mat2& rest = g.rest.edges[t];
        const Fabric& f = fabrics[g.panel_of_triangle[t]];
        const double area = 0.5 * std::abs(rest.determinant());
        if (area == 0) continue;
        GrainTriangle y;
        y.nodes = g.nodes(int(t));
        y.shape.bottomRows<2>() = rest.inverse();
        y.shape.row(0) = -y.shape.bottomRows<2>().colwise().sum();
        std::array<double, 2> stretch{f.stretch_weft * area, f.stretch_warp * area};
        for (int k = 0; k < 3; ++k) {
            const int c = direction_of(flat_edge(g, int(t), k));
            if (c >= 0 && kept.count(g.edges.ends[g.edges.of_triangle[t][k]])) stretch[c] = 0;
        }
        y.weft = stretch[0];
        y.warp = stretch[1];
        y.shear = f.shear * area;
        triangles_.push_back(y);
    }
}

double YarnCloth::value(const Points& x) const {
    double sum = tension.value(x) + bend_value(bending_, x);
    for (const GrainTriangle& t : triangles_) sum += energy(t, images(t, x));
    return sum;
}

void YarnCloth::add_gradient(const Points& x, Eigen::VectorXd& g) const {
    tension.add_gradient(x, g);
    Points bent(x.size(), Vec3::Zero());
    bend_gradient(bending_, x, bent);
    g += flat(bent);
    for (const GrainTriangle& t : triangles_) {
        const Slope s = slope(t, images(t, x));
        for (int k = 0; k < 3; ++k)
            g.segment<3>(3 * t.nodes[k]) += t.shape(k, 0) * s.head<3>() + t.shape(k, 1) * s.tail<3>();
    }
}

void YarnCloth::couplings(std::vector<std::pair<int, int>>& pairs) const {
    tension.couplings(pairs);
    for (const GrainTriangle& t : triangles_)
        for (int k = 0; k < 3; ++k) pairs.emplace_back(t.nodes[k], t.nodes[(k + 1) % 3]);
    for (int j = 0; j < bending_.stiffness.outerSize(); ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator entry(bending_.stiffness, j); entry; ++entry)
            if (entry.row() > j) pairs.emplace_back(int(entry.row()), j);
}

void YarnCloth::add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const {
    tension.add_hessian(x, kind, h);
    for (int j = 0; j < bending_.stiffness.outerSize(); ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator entry(bending_.stiffness, j); entry; ++entry) {
            const Mat3 block = entry.value() * Mat3::Identity();
            if (entry.row() == j)
                h.add_diagonal(j, block);
            else if (entry.row() > j)
                h.add_off_diagonal(j, h.find(int(entry.row()), j), block);
        }
    for (const GrainTriangle& t : triangles_) {
        const Stiffness c = stiffness(t, images(t, x), kind);
        Eigen::Matrix<double, 9, 9> block;
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) {
                Mat3 sum = Mat3::Zero();
                for (int p = 0; p < 2; ++p)
                    for (int q = 0; q < 2; ++q) sum += t.shape(k, p) * t.shape(l, q) * c.block<3, 3>(3 * p, 3 * q);
                block.block<3, 3>(3 * k, 3 * l) = sum;
            }
        h.add_element(t.nodes, block);
    }
}

} // namespace toile
