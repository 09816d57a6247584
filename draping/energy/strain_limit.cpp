// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/strain_limit.h"

#include "geometry/parallel.h"

#include <Eigen/Dense>

#include <algorithm>
#include <limits>

namespace toile {

namespace {

constexpr double onset = 0.6;
constexpr double tiny = 1e-4; // keeps the shear angle of a collapsed triangle defined
constexpr double never = std::numeric_limits<double>::infinity();
constexpr int chunk = 256;

// Yarns in the metric c = (|F_weft|^2, |F_warp|^2, F_weft . F_warp).
struct Metric {
    GrainImages yarns;
    Vec3 c;
};

Metric metric_of(const StrainLimit& limit, const Points& x) {
    Metric m;
    m.yarns = grain_images(limit.nodes, limit.shape, x);
    m.c << m.yarns.col(0).squaredNorm(), m.yarns.col(1).squaredNorm(), m.yarns.col(0).dot(m.yarns.col(1));
    return m;
}

// Value and two derivatives of -s^2 log(1 - s), zero for s <= 0, and of its quadratic continuation beyond
// `turn`.
struct Barrier {
    double value = 0, slope = 0, bend = 0;
};

Barrier barrier(double s, double turn) {
    if (s <= 0) return {};
    const double at = std::min(s, turn), log = std::log1p(-at), gap = 1 - at;
    Barrier b{-at * at * log, -2 * at * log + at * at / gap,
              -2 * log + 4 * at / gap + at * at / (gap * gap)};
    const double beyond = s - at;
    b.value += beyond * (b.slope + 0.5 * beyond * b.bend);
    b.slope += beyond * b.bend;
    return b;
}

// A barrier of the yarn's Green strain, as a function of |F|^2; `largest` is |F|^2 at the limit.
Barrier yarn_barrier(double squared, double largest, double stiffness, double turn) {
    if (largest == never) return {};
    const double range = (1 - onset) * (largest - 1);
    Barrier b = barrier((squared - 1 - onset * (largest - 1)) / range, turn);
    return {stiffness * b.value, stiffness / range * b.slope, stiffness / (range * range) * b.bend};
}

// Sine squared of the shear angle and its derivatives by the metric.
struct Shear {
    double value = 0;
    Vec3 slope;
    Mat3 bend;
};

Shear shear_of(const Vec3& c) {
    const double p = c[0] * c[1] + tiny, r = c[2] * c[2];
    const Vec3 dp(c[1], c[0], 0), dr(0, 0, 2 * c[2]);
    Mat3 pp = Mat3::Zero(), rr = Mat3::Zero();
    pp(0, 1) = pp(1, 0) = 1;
    rr(2, 2) = 2;
    Shear s;
    s.value = r / p;
    s.slope = dr / p - r / (p * p) * dp;
    s.bend = rr / p - (dr * dp.transpose() + dp * dr.transpose()) / (p * p) - r / (p * p) * pp +
             2 * r / (p * p * p) * dp * dp.transpose();
    return s;
}

// Energy as a function of the metric.
struct MetricEnergy {
    double value = 0;
    Vec3 slope = Vec3::Zero();
    Mat3 bend = Mat3::Zero();
    bool acts = false;
};

void add(MetricEnergy& energy, const Barrier& b, const Vec3& slope, const Mat3& bend) {
    if (b.value <= 0) return;
    energy.acts = true;
    energy.value += b.value;
    energy.slope += b.slope * slope;
    energy.bend += b.bend * slope * slope.transpose() + b.slope * bend;
}

MetricEnergy energy_of(const StrainLimit& limit, const Vec3& c) {
    MetricEnergy energy;
    add(energy, yarn_barrier(c[0], limit.weft, limit.weft_stiffness, limit.turn), Vec3::UnitX(), Mat3::Zero());
    add(energy, yarn_barrier(c[1], limit.warp, limit.warp_stiffness, limit.turn), Vec3::UnitY(), Mat3::Zero());
    const double squared = c[2] * c[2] / (c[0] * c[1] + tiny), onset_squared = onset * onset;
    if (limit.shear == never || squared <= onset_squared * limit.shear) return energy;
    // As for the yarns, but from 60 % of the sine, which is 36 % of its square.
    const Shear shear = shear_of(c);
    const double range = (1 - onset_squared) * limit.shear;
    const Barrier b = barrier((shear.value - onset_squared * limit.shear) / range, limit.turn);
    const double k = limit.shear_stiffness;
    add(energy, {k * b.value, k / range * b.slope, k / (range * range) * b.bend}, shear.slope, shear.bend);
    return energy;
}

template <class Matrix> Matrix without_negative(const Matrix& m) {
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(m);
    return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0).asDiagonal() *
           solver.eigenvectors().transpose();
}

// 2 x 2 "stress" that multiplies the yarns: d energy = yarns stress : d yarns.
Mat2 stress_of(const Vec3& slope) {
    Mat2 stress;
    stress << 2 * slope[0], slope[2], slope[2], 2 * slope[1];
    return stress;
}

double squared_limit(double stretch) {
    return stretch > 0 ? (1 + stretch) * (1 + stretch) : never;
}

double strain_scale(double largest) {
    return largest == never ? 0 : 0.25 * (largest - 1) * (largest - 1);
}

/// Of the straight line with which the membrane would hold as much at the limit.
double stiffness_at(double largest, double constant, const std::vector<StretchPoint>& curve) {
    if (curve.empty() || largest == never) return constant;
    return secants(membrane_curve(curve), 0.5 * (largest - 1)).by_energy;
}

} // namespace

std::vector<StrainLimit> make_strain_limits(const Garment& garment, const std::vector<Fabric>& fabrics) {
    std::vector<StrainLimit> limits;
    std::vector<Vec2> stiffness; // of weft and warp, per panel
    for (const Fabric& f : fabrics)
        stiffness.emplace_back(stiffness_at(squared_limit(f.limit_weft), f.stretch_weft, f.curve_weft),
                               stiffness_at(squared_limit(f.limit_warp), f.stretch_warp, f.curve_warp));
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        const Fabric& fabric = fabrics[garment.panel_of_triangle[t]];
        const Vec2& resisted = stiffness[garment.panel_of_triangle[t]];
        const Mat2& edges = garment.rest.edges[t];
        StrainLimit limit;
        limit.nodes = garment.nodes(t);
        limit.shape = grain_shape(edges);
        limit.weft = squared_limit(fabric.limit_weft);
        limit.warp = squared_limit(fabric.limit_warp);
        limit.shear = fabric.limit_shear > 0 ? std::pow(std::sin(fabric.limit_shear), 2) : never;
        // As much energy as the membrane holds at the limit: the barrier is about as stiff as the cloth where
        // it begins, and many times as stiff near the limit.
        const double area = rest_area(edges);
        limit.weft_stiffness = area * resisted[0] * strain_scale(limit.weft);
        limit.warp_stiffness = area * resisted[1] * strain_scale(limit.warp);
        limit.shear_stiffness = limit.shear == never ? 0 : area * fabric.shear * limit.shear;
        limits.push_back(limit);
    }
    return limits;
}

std::vector<int> beyond_strain_limits(const std::vector<StrainLimit>& limits, const Points& x) {
    std::vector<int> beyond;
    for (int t = 0; t < int(limits.size()); ++t) {
        const Vec3 c = metric_of(limits[t], x).c;
        if (c[0] >= limits[t].weft || c[1] >= limits[t].warp ||
            c[2] * c[2] >= limits[t].shear * (c[0] * c[1] + tiny))
            beyond.push_back(t);
    }
    return beyond;
}

double strain_limit_value(const StrainLimit& limit, const Points& x) {
    return energy_of(limit, metric_of(limit, x).c).value;
}

double strain_limit_value(const std::vector<StrainLimit>& limits, const Points& x) {
    return parallel_sum(int(limits.size()), chunk, [&](int begin, int end) {
        double sum = 0;
        for (int t = begin; t < end; ++t)
            sum += strain_limit_value(limits[t], x);
        return sum;
    });
}

void strain_limit_gradient(const std::vector<StrainLimit>& limits, const Points& x, Points& gradient) {
    for (const StrainLimit& limit : limits) {
        const Metric m = metric_of(limit, x);
        const MetricEnergy energy = energy_of(limit, m.c);
        if (!energy.acts) continue;
        const Eigen::Matrix<double, 3, 3> g = m.yarns * stress_of(energy.slope) * limit.shape.transpose();
        for (int a = 0; a < 3; ++a)
            gradient[limit.nodes[a]] += g.col(a);
    }
}

bool strain_limit_hessian(const StrainLimit& limit, const Points& x, HessianKind kind,
                          Eigen::Matrix<double, 9, 9>& hessian) {
    const Metric m = metric_of(limit, x);
    const MetricEnergy energy = energy_of(limit, m.c);
    if (!energy.acts) return false;
    const bool project = kind == HessianKind::projected;
    Eigen::Matrix<double, 3, 9> metric; // derivative of c
    for (int a = 0; a < 3; ++a) {
        const auto at = 3 * a;
        metric.block<1, 3>(0, at) = 2 * limit.shape(a, 0) * m.yarns.col(0).transpose();
        metric.block<1, 3>(1, at) = 2 * limit.shape(a, 1) * m.yarns.col(1).transpose();
        metric.block<1, 3>(2, at) =
            (limit.shape(a, 0) * m.yarns.col(1) + limit.shape(a, 1) * m.yarns.col(0)).transpose();
    }
    const Mat3 bend = project ? without_negative(energy.bend) : energy.bend;
    const Mat2 stress = project ? without_negative(stress_of(energy.slope)) : stress_of(energy.slope);
    hessian = metric.transpose() * bend * metric;
    const Mat3 geometric = limit.shape * stress * limit.shape.transpose();
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            for (int i = 0; i < 3; ++i)
                hessian(3 * a + i, 3 * b + i) += geometric(a, b);
    return true;
}

} // namespace toile
