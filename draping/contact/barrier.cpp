// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/barrier.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>
#include <limits>

namespace toile {

double Barrier::energy(double d) const {
    const double range = distance - floor, t = (d - floor) / range;
    if (t >= 1) return 0;
    if (t <= 0) return std::numeric_limits<double>::infinity();
    return -stiffness * range * range * (1 - t) * (1 - t) * std::log(t);
}

double Barrier::slope(double d) const {
    const double range = distance - floor, t = (d - floor) / range;
    if (t >= 1) return 0;
    return stiffness * range * (2 * (1 - t) * std::log(t) - (1 - t) * (1 - t) / t);
}

double Barrier::curvature(double d) const {
    const double t = (d - floor) / (distance - floor);
    if (t >= 1) return 0;
    return stiffness * (-2 * std::log(t) + 4 * (1 - t) / t + (1 - t) * (1 - t) / (t * t));
}

PairGeometry pair_geometry(const std::array<Vec3, 4>& x, bool edge_edge) {
    const Nearest n =
        edge_edge ? nearest_edge_edge(x[0], x[1], x[2], x[3]) : nearest_point_triangle(x[0], x[1], x[2], x[3]);
    PairGeometry g;
    g.active = n.active;
    const int second = edge_edge ? 2 : 1;
    for (int k = 0; k < 4; ++k) g.weight[k] = k < second ? n.weight[k] : -n.weight[k];
    // From differences, so that gaps of micrometres keep their digits a metre from the origin.
    Vec3 r = Vec3::Zero();
    for (int k = 1; k < 4; ++k) r += g.weight[k] * (x[k] - x[0]);
    g.d = r.norm();
    if (g.d > 0) g.normal = r / g.d;
    return g;
}

Eigen::Matrix<double, 12, 12> distance_hessian(const std::array<Vec3, 4>& x, const PairGeometry& g, bool edge_edge) {
    // D = min over the free weights p of |r|^2, r = sum w_i(p) x_i. By the envelope theorem
    // D'' = 2 (w w^T (x) I - G (J^T J)^-1 G^T), J = dr/dp, G_i = r (dw_i/dp)^T + w_i J.
    const Vec3 r = g.d * g.normal;
    int parameters = 0;
    std::array<std::array<double, 4>, 2> dw{}; // dw[p][i]
    Eigen::Matrix<double, 3, 2> j = Eigen::Matrix<double, 3, 2>::Zero();
    const auto add = [&](int from, int to, double sign) {
        dw[parameters][from] = -sign;
        dw[parameters][to] = sign;
        j.col(parameters) = sign * (x[to] - x[from]);
        ++parameters;
    };
    const auto on = [&](int k) { return (g.active >> k & 1) != 0; };
    if (edge_edge) {
        if (on(0) && on(1)) add(0, 1, 1);
        if (on(2) && on(3)) add(2, 3, -1);
    } else {
        int base = 0;
        for (int k = 1; k < 4; ++k) {
            if (!on(k)) continue;
            if (base)
                add(base, k, -1);
            else
                base = k;
        }
    }
    Eigen::Matrix<double, 12, 12> h;
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) h.block<3, 3>(3 * a, 3 * b) = g.weight[a] * g.weight[b] * Mat3::Identity();
    if (parameters > 0) {
        Eigen::Matrix<double, 12, 2> big = Eigen::Matrix<double, 12, 2>::Zero();
        for (int a = 0; a < 4; ++a)
            for (int p = 0; p < parameters; ++p)
                big.block<3, 1>(3 * a, p) = dw[p][a] * r + g.weight[a] * j.col(p);
        Mat2 m = j.transpose() * j;
        if (parameters == 1) m(1, 1) = 1;
        if (m.determinant() > 1e-12 * m(0, 0) * m(1, 1)) h -= big * m.inverse() * big.transpose();
    }
    // D = d^2: d'' = (D''/2 - d' d'^T) / d.
    Eigen::Matrix<double, 12, 1> gradient;
    for (int a = 0; a < 4; ++a) gradient.segment<3>(3 * a) = g.weight[a] * g.normal;
    return (h - gradient * gradient.transpose()) / g.d;
}

// Squared sine of the angle between edges, times their squared lengths, below which they fade: a share of `scale`.
constexpr double fade_share = 1e-3;

ParallelFade parallel_fade(const std::array<Vec3, 4>& x, double scale) {
    ParallelFade fade;
    const Vec3 u = x[1] - x[0], v = x[3] - x[2];
    const double c = u.cross(v).squaredNorm(), limit = fade_share * scale;
    if (c >= limit) return fade;
    fade.fading = true;
    const double y = c / limit;
    fade.value = y * (2 - y);
    const double slope = 2 * (1 - y) / limit; // d value / dc
    const Vec3 du = 2 * (v.squaredNorm() * u - u.dot(v) * v), dv = 2 * (u.squaredNorm() * v - u.dot(v) * u);
    fade.gradient = {-slope * du, slope * du, -slope * dv, slope * dv};
    return fade;
}

Eigen::Matrix<double, 12, 12> parallel_fade_hessian(const std::array<Vec3, 4>& x, double scale) {
    const Vec3 u = x[1] - x[0], v = x[3] - x[2];
    const double limit = fade_share * scale, y = u.cross(v).squaredNorm() / limit;
    // Over (u, v): c = |u|^2 |v|^2 - (u.v)^2, value = y (2 - y), y = c / limit.
    Eigen::Matrix<double, 6, 1> dc;
    dc << 2 * (v.squaredNorm() * u - u.dot(v) * v), 2 * (u.squaredNorm() * v - u.dot(v) * u);
    Eigen::Matrix<double, 6, 6> h = -2 / (limit * limit) * dc * dc.transpose();
    const double slope = 2 * (1 - y) / limit;
    const Mat3 mixed = 4 * u * v.transpose() - 2 * v * u.transpose() - 2 * u.dot(v) * Mat3::Identity();
    h.topLeftCorner<3, 3>() += slope * 2 * (v.squaredNorm() * Mat3::Identity() - v * v.transpose());
    h.bottomRightCorner<3, 3>() += slope * 2 * (u.squaredNorm() * Mat3::Identity() - u * u.transpose());
    h.topRightCorner<3, 3>() += slope * mixed;
    h.bottomLeftCorner<3, 3>() += slope * mixed.transpose();
    Eigen::Matrix<double, 12, 12> over_points;
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b)
            over_points.block<3, 3>(3 * a, 3 * b) = (a % 2 == b % 2 ? 1 : -1) * h.block<3, 3>(3 * (a / 2), 3 * (b / 2));
    return over_points;
}

} // namespace toile
