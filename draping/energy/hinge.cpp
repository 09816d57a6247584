// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/hinge.h"

#include "draping/energy/bend.h"

#include <Eigen/Geometry>

#include <cmath>

namespace toile {

namespace {

using Rows = Eigen::Matrix<double, 3, 12>; // derivative of a vector by the four nodes
using Row = Eigen::Matrix<double, 1, 12>;

Mat3 cross_matrix(const Vec3& v) {
    Mat3 m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

/// Derivative of x[k] - x[0].
Rows from_first(int k) {
    Rows d = Rows::Zero();
    d.leftCols<3>() = -Mat3::Identity();
    d.middleCols<3>(3 * k) = Mat3::Identity();
    return d;
}

/// How far the angle is from rest. Not the short way round, which from a fold the wrong way leads through the cloth.
double turned(const HingeBend& b, double angle) { return angle - b.rest; }

HingeBend make_hinge_bend(const Garment& garment, const std::vector<Fabric>& fabrics, const Hinge& hinge) {
    double d = 0, length = 0, area = 0;
    for (const int t : hinge.triangles) {
        const auto& of = garment.edges.of_triangle[t];
        const int k = int(std::find(of.begin(), of.end(), hinge.edge) - of.begin());
        const Vec2 edge = rest_edge(garment.rest.edges[t], k), across(-edge.y(), edge.x());
        d += bend_modulus(fabrics[garment.panel_of_triangle[t]], std::atan2(across.x(), across.y())) / 2;
        length += edge.norm() / 2;
        area += rest_area(garment.rest.edges[t]);
    }
    const double altitude = area / length; // the mean of both
    if (is_crease(garment, hinge.edge)) return {hinge.nodes, garment.rest.angles[hinge.edge], d * length / crease_width};
    return {hinge.nodes, 0, d * area / (altitude * altitude)};
}

} // namespace

std::vector<Hinge> hinges_of(const EdgeTable& edges, const std::vector<Triangle>& triangles) {
    std::vector<Hinge> hinges;
    for (int e = 0; e < edges.size(); ++e) {
        if (edges.triangles_at(e) != 2) continue;
        Hinge hinge;
        hinge.edge = e;
        for (int side = 0; side < 2; ++side) {
            const int t = edges.incident[edges.first[e] + side];
            const Triangle nodes = triangles[t];
            hinge.triangles[side] = t;
            for (int k = 0; k < 3; ++k) {
                if (edges.of_triangle[t][k] != e) continue;
                hinge.nodes[2 + side] = nodes[k];
                if (side > 0) continue;
                hinge.nodes[0] = nodes[(k + 1) % 3];
                hinge.nodes[1] = nodes[(k + 2) % 3];
            }
        }
        hinges.push_back(hinge);
    }
    return hinges;
}

HingeAngle hinge_angle(const std::array<Vec3, 4>& x) {
    const Vec3 e = x[1] - x[0], n0 = e.cross(x[2] - x[0]), n1 = (x[3] - x[0]).cross(e);
    const double length = e.norm();
    HingeAngle angle;
    angle.value = std::atan2(n0.cross(n1).dot(e) / length, n0.dot(n1));
    angle.gradient[2] = -length / n0.squaredNorm() * n0;
    angle.gradient[3] = -length / n1.squaredNorm() * n1;
    const auto foot = [&](int far) { return (x[far] - x[0]).dot(e) / e.squaredNorm(); };
    angle.gradient[0] = -(1 - foot(2)) * angle.gradient[2] - (1 - foot(3)) * angle.gradient[3];
    angle.gradient[1] = -foot(2) * angle.gradient[2] - foot(3) * angle.gradient[3];
    return angle;
}

// The derivative of the gradient above, row by row: that of a far corner is -|e| n / |n|^2, and those of the ends follow
// from it by where the far corners' feet lie on the edge.
Eigen::Matrix<double, 12, 12> hinge_hessian(const std::array<Vec3, 4>& x) {
    const Vec3 e = x[1] - x[0];
    const double squared = e.squaredNorm(), length = std::sqrt(squared);
    const Rows de = from_first(1);
    const Row dlength = (e / length).transpose() * de;
    std::array<Vec3, 2> g;
    std::array<Rows, 2> dg;
    std::array<double, 2> foot{};
    std::array<Row, 2> dfoot;
    for (int side = 0; side < 2; ++side) {
        const Vec3 a = x[2 + side] - x[0];
        const Rows da = from_first(2 + side);
        const double sign = side == 0 ? 1 : -1;
        const Vec3 n = sign * e.cross(a);
        const Rows dn = sign * (cross_matrix(e) * da - cross_matrix(a) * de);
        const double nn = n.squaredNorm();
        const Vec3 unit = n / std::sqrt(nn);
        g[side] = -length / nn * n;
        dg[side] = -n / nn * dlength - length / nn * (Mat3::Identity() - 2 * unit * unit.transpose()) * dn;
        foot[side] = a.dot(e) / squared;
        dfoot[side] = (e.transpose() * da + (a - 2 * foot[side] * e).transpose() * de) / squared;
    }
    Eigen::Matrix<double, 12, 12> h;
    h.middleRows<3>(6) = dg[0];
    h.middleRows<3>(9) = dg[1];
    h.topRows<3>() = g[0] * dfoot[0] - (1 - foot[0]) * dg[0] + g[1] * dfoot[1] - (1 - foot[1]) * dg[1];
    h.middleRows<3>(3) = -g[0] * dfoot[0] - foot[0] * dg[0] - g[1] * dfoot[1] - foot[1] * dg[1];
    return (h + h.transpose()) / 2; // equal but for rounding
}

std::vector<HingeBend> make_hinge_bends(const Garment& garment, const std::vector<Fabric>& fabrics) {
    std::vector<HingeBend> bends;
    for (const Hinge& hinge : hinges_of(garment)) bends.push_back(make_hinge_bend(garment, fabrics, hinge));
    return bends;
}

std::vector<HingeBend> make_creases(const Garment& garment, const std::vector<Fabric>& fabrics) {
    std::vector<HingeBend> creases;
    for (const Hinge& hinge : hinges_of(garment))
        if (is_crease(garment, hinge.edge)) creases.push_back(make_hinge_bend(garment, fabrics, hinge));
    return creases;
}

double value(const std::vector<HingeBend>& bends, const Points& x) {
    double sum = 0;
    for (const HingeBend& b : bends) {
        const double off = turned(b, hinge_angle(b.nodes, x).value);
        sum += 0.5 * b.stiffness * off * off;
    }
    return sum;
}

void add_gradient(const std::vector<HingeBend>& bends, const Points& x, Eigen::VectorXd& g) {
    for (const HingeBend& b : bends) {
        const HingeAngle angle = hinge_angle(b.nodes, x);
        for (int k = 0; k < 4; ++k)
            g.segment<3>(3 * b.nodes[k]) += b.stiffness * turned(b, angle.value) * angle.gradient[k];
    }
}

Constraint constraint(const HingeBend& bend, const Points& x) {
    const HingeAngle angle = hinge_angle(bend.nodes, x);
    return {4, bend.nodes, turned(bend, angle.value), angle.gradient, bend.stiffness};
}

void couplings(const std::vector<HingeBend>& bends, std::vector<std::pair<int, int>>& pairs) {
    for (const HingeBend& b : bends)
        for (int k = 0; k < 4; ++k)
            for (int l = 0; l < k; ++l) pairs.emplace_back(b.nodes[k], b.nodes[l]);
}

void add_hessian(const std::vector<HingeBend>& bends, const Points& x, HessianKind kind, BlockMatrix& h) {
    for (const HingeBend& b : bends) {
        const std::array<Vec3, 4> at = hinge_corners(b.nodes, x);
        const HingeAngle angle = hinge_angle(at);
        Eigen::Matrix<double, 12, 1> slope;
        for (int k = 0; k < 4; ++k) slope.segment<3>(3 * k) = angle.gradient[k];
        Eigen::Matrix<double, 12, 12> block = b.stiffness * slope * slope.transpose();
        if (kind == HessianKind::exact) block += b.stiffness * turned(b, angle.value) * hinge_hessian(at);
        h.add_element(b.nodes, block);
    }
}

} // namespace toile
