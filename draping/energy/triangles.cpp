// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/triangles.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

using Yarns = Eigen::Matrix<double, 3, 2>;  // images of the unit directions of weft and warp
using Slope = Eigen::Matrix<double, 6, 1>;  // by the weft's image, then by the warp's
using Bend = Eigen::Matrix<double, 6, 6>;

constexpr double least_length = 1e-6; // of a yarn's image: keeps a collapsed triangle's angle defined
constexpr double least_sine = 1e-9;

Yarns yarns_of(const YarnTriangle& t, const Points& x) {
    Yarns edges;
    edges << x[t.nodes[1]] - x[t.nodes[0]], x[t.nodes[2]] - x[t.nodes[0]];
    return edges * t.shape.bottomRows<2>();
}

/// The cosine between the images, and what its derivatives are made of.
struct Between {
    double length[2];
    Vec3 unit[2];
    double cosine = 0, sine = 1;

    explicit Between(const Yarns& y) {
        for (int k = 0; k < 2; ++k) {
            length[k] = std::max(y.col(k).norm(), least_length);
            unit[k] = y.col(k) / length[k];
        }
        cosine = unit[0].dot(unit[1]);
        sine = std::max(unit[0].cross(unit[1]).norm(), least_sine);
    }
    double gamma() const { return std::atan2(cosine, sine); }
    Slope cosine_slope() const {
        Slope g;
        g << (unit[1] - cosine * unit[0]) / length[0], (unit[0] - cosine * unit[1]) / length[1];
        return g;
    }
    Bend cosine_bend() const {
        const Slope g = cosine_slope();
        Bend h;
        for (int k = 0; k < 2; ++k) {
            const Vec3 u = unit[k], gk = g.segment<3>(3 * k);
            h.block<3, 3>(3 * k, 3 * k) = -(u * gk.transpose() + gk * u.transpose()) / length[k] -
                                          cosine * (Mat3::Identity() - u * u.transpose()) / (length[k] * length[k]);
        }
        h.block<3, 3>(0, 3) = ((Mat3::Identity() - unit[1] * unit[1].transpose()) / length[1] -
                               unit[0] * g.tail<3>().transpose()) / length[0];
        h.block<3, 3>(3, 0) = h.block<3, 3>(0, 3).transpose();
        return h;
    }
};

double energy(const YarnTriangle& t, const Yarns& y) {
    const Between b(y);
    const double u = b.length[0] - 1, v = b.length[1] - 1, gamma = b.gamma();
    return 0.5 * (t.weft * u * u + t.warp * v * v + t.shear * gamma * gamma);
}

Slope slope(const YarnTriangle& t, const Yarns& y) {
    const Between b(y);
    Slope g = t.shear * b.gamma() / b.sine * b.cosine_slope();
    g.head<3>() += t.weft * (b.length[0] - 1) * b.unit[0];
    g.tail<3>() += t.warp * (b.length[1] - 1) * b.unit[1];
    return g;
}

/// Projected: yarns under compression without what turns them, and shear without the second derivative of its angle.
Bend bend(const YarnTriangle& t, const Yarns& y, HessianKind kind) {
    const Between b(y);
    const Slope c = b.cosine_slope();
    Bend h = t.shear / (b.sine * b.sine) * c * c.transpose();
    if (kind == HessianKind::exact)
        h += t.shear * b.gamma() *
             (b.cosine_bend() / b.sine + b.cosine / std::pow(b.sine, 3) * c * c.transpose());
    for (int k = 0; k < 2; ++k) {
        double turning = 1 - 1 / b.length[k];
        if (kind == HessianKind::projected) turning = std::max(turning, 0.0);
        const Mat3 along = b.unit[k] * b.unit[k].transpose();
        h.block<3, 3>(3 * k, 3 * k) += (k == 0 ? t.weft : t.warp) * (along + turning * (Mat3::Identity() - along));
    }
    return h;
}

} // namespace

TriangleCloth::TriangleCloth(const Garment& garment, const std::vector<Fabric>& fabrics)
    : bends_(make_hinge_bends(garment, fabrics)) {
    for (std::size_t t = 0; t < garment.triangles.size(); ++t) {
        const Mat2& rest = garment.rest.edges[t];
        const Fabric& f = fabrics[garment.panel_of_triangle[t]];
        const double area = 0.5 * std::abs(rest.determinant());
        YarnTriangle y;
        y.nodes = garment.nodes(int(t));
        y.shape.bottomRows<2>() = rest.inverse();
        y.shape.row(0) = -y.shape.bottomRows<2>().colwise().sum();
        y.weft = f.stretch_weft * area;
        y.warp = f.stretch_warp * area;
        y.shear = f.shear * area;
        triangles_.push_back(y);
    }
}

double TriangleCloth::value(const Points& x) const {
    double sum = toile::value(bends_, x);
    for (const YarnTriangle& t : triangles_) sum += energy(t, yarns_of(t, x));
    return sum;
}

void TriangleCloth::add_gradient(const Points& x, Eigen::VectorXd& g) const {
    toile::add_gradient(bends_, x, g);
    for (const YarnTriangle& t : triangles_) {
        const Slope s = slope(t, yarns_of(t, x));
        for (int k = 0; k < 3; ++k)
            g.segment<3>(3 * t.nodes[k]) += t.shape(k, 0) * s.head<3>() + t.shape(k, 1) * s.tail<3>();
    }
}

Constraint TriangleCloth::constraint(int k, const Points& x) const {
    if (k >= int(3 * triangles_.size())) return toile::constraint(bends_[k - 3 * triangles_.size()], x);
    const YarnTriangle& t = triangles_[k / 3];
    const Between b(yarns_of(t, x));
    const int which = k % 3;
    Slope s = Slope::Zero();
    Constraint c;
    c.count = 3;
    c.stiffness = which == 0 ? t.weft : which == 1 ? t.warp : t.shear;
    if (which == 2) {
        c.value = b.gamma();
        s = b.cosine_slope() / b.sine;
    } else {
        c.value = b.length[which] - 1;
        s.segment<3>(3 * which) = b.unit[which];
    }
    for (int i = 0; i < 3; ++i) {
        c.nodes[i] = t.nodes[i];
        c.gradient[i] = t.shape(i, 0) * s.head<3>() + t.shape(i, 1) * s.tail<3>();
    }
    return c;
}

void TriangleCloth::couplings(std::vector<std::pair<int, int>>& pairs) const {
    toile::couplings(bends_, pairs);
    for (const YarnTriangle& t : triangles_)
        for (int k = 0; k < 3; ++k) pairs.emplace_back(t.nodes[k], t.nodes[(k + 1) % 3]);
}

void TriangleCloth::add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const {
    toile::add_hessian(bends_, x, kind, h);
    for (const YarnTriangle& t : triangles_) {
        const Bend b = bend(t, yarns_of(t, x), kind);
        Eigen::Matrix<double, 9, 9> block;
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) {
                Mat3 sum = Mat3::Zero();
                for (int p = 0; p < 2; ++p)
                    for (int q = 0; q < 2; ++q)
                        sum += t.shape(k, p) * t.shape(l, q) * b.block<3, 3>(3 * p, 3 * q);
                block.block<3, 3>(3 * k, 3 * l) = sum;
            }
        h.add_element(t.nodes, block);
    }
}

} // namespace toile
