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
    Eigen::Matrix<double, 3, 2> yarns;
    Vec3 c;
};

Metric metric_of(const StrainLimit& limit, const Points& x) {
    Eigen::Matrix<double, 3, 2> edges;
    edges << x[limit.nodes[1]] - x[limit.nodes[0]], x[limit.nodes[2]] - x[limit.nodes[0]];
    Metric m;
    m.yarns = edges * limit.shape.bottomRows<2>();
    m.c << m.yarns.col(0).squaredNorm(), m.yarns.col(1).squaredNorm(), m.yarns.col(0).dot(m.yarns.col(1));
    return m;
}

// Value and two derivatives of -s^2 log(1 - s), zero for s <= 0.
struct Barrier {
    double value = 0, slope = 0, bend = 0;
};

Barrier barrier(double s) {
    if (s <= 0) return {};
    if (s >= 1) return {never, never, never};
    const double log = std::log1p(-s), gap = 1 - s;
    return {-s * s * log, -2 * s * log + s * s / gap, -2 * log + 4 * s / gap + s * s / (gap * gap)};
}

// A barrier of the yarn's Green strain, as a function of |F|^2; `largest` is |F|^2 at the limit.
Barrier yarn_barrier(double squared, double largest, double stiffness) {
    if (largest == never) return {};
    const double range = (1 - onset) * (largest - 1);
    Barrier b = barrier((squared - 1 - onset * (largest - 1)) / range);
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
    add(energy, yarn_barrier(c[0], limit.weft, limit.weft_stiffness), Vec3::UnitX(), Mat3::Zero());
    add(energy, yarn_barrier(c[1], limit.warp, limit.warp_stiffness), Vec3::UnitY(), Mat3::Zero());
    const double squared = c[2] * c[2] / (c[0] * c[1] + tiny), onset_squared = onset * onset;
    if (limit.shear == never || squared <= onset_squared * limit.shear) return energy;
    // As for the yarns, but from 60 % of the sine, which is 36 % of its square.
    const Shear shear = shear_of(c);
    const double range = (1 - onset_squared) * limit.shear;
    const Barrier b = barrier((shear.value - onset_squared * limit.shear) / range);
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

// Smallest root in [0, end] of the polynomial sum_i p[i] a^i, or infinity; 0 when it is not negative at 0.
// Between the roots of its derivative a polynomial is monotonic, so bisection there cannot miss one; the
// bracket's lower end is returned, where the polynomial is still negative.
double first_root(const std::vector<double>& p, double end) {
    const int degree = int(p.size()) - 1;
    const auto value = [&](double a) {
        double v = 0;
        for (int i = degree; i >= 0; --i)
            v = v * a + p[i];
        return v;
    };
    if (p[0] >= 0) return 0;
    std::vector<double> knots{0};
    // All critical points in [0, end], from those of the derivatives, lowest degree first.
    for (int d = degree - 1; d >= 1; --d) {
        std::vector<double> q(p);
        for (int n = 0; n < d; ++n) {
            for (std::size_t i = 1; i < q.size(); ++i)
                q[i - 1] = double(i) * q[i];
            q.pop_back();
        }
        const auto derivative = [&](double a) {
            double v = 0;
            for (int i = int(q.size()) - 1; i >= 0; --i)
                v = v * a + q[i];
            return v;
        };
        std::vector<double> next{0}, ends(knots);
        ends.push_back(end);
        for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
            double low = ends[i], high = ends[i + 1];
            if ((derivative(low) > 0) == (derivative(high) > 0)) continue;
            for (int n = 0; n < 60; ++n) {
                const double middle = (low + high) / 2;
                ((derivative(middle) > 0) == (derivative(low) > 0) ? low : high) = middle;
            }
            next.push_back(high);
        }
        knots = next;
    }
    knots.push_back(end);
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        double low = knots[i], high = knots[i + 1];
        if (value(high) < 0) continue;
        for (int n = 0; n < 60; ++n) {
            const double middle = (low + high) / 2;
            (value(middle) < 0 ? low : high) = middle;
        }
        return low;
    }
    return never;
}

std::vector<double> times(const Vec3& a, const Vec3& b) {
    return {a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[1] * b[1] + a[2] * b[0],
            a[1] * b[2] + a[2] * b[1], a[2] * b[2]};
}

// Largest step in [0, 1] of one triangle.
double step_of(const StrainLimit& limit, const Points& x, const Points& direction) {
    const Eigen::Matrix<double, 3, 2> f = metric_of(limit, x).yarns, d = metric_of(limit, direction).yarns;
    // Polynomials in the step of |F_weft|^2, |F_warp|^2 and F_weft . F_warp.
    const Vec3 weft(f.col(0).squaredNorm(), 2 * f.col(0).dot(d.col(0)), d.col(0).squaredNorm());
    const Vec3 warp(f.col(1).squaredNorm(), 2 * f.col(1).dot(d.col(1)), d.col(1).squaredNorm());
    const Vec3 both(f.col(0).dot(f.col(1)), f.col(0).dot(d.col(1)) + f.col(1).dot(d.col(0)),
                    d.col(0).dot(d.col(1)));
    double step = 1;
    const auto yarn = [&](const Vec3& p, double largest) {
        if (largest < never && p[0] + std::max(p[1], 0.0) + p[2] >= largest)
            step = std::min(step, first_root({p[0] - largest, p[1], p[2]}, 1));
    };
    yarn(weft, limit.weft);
    yarn(warp, limit.warp);
    const double least = (weft[0] + std::min(weft[1], 0.0)) * (warp[0] + std::min(warp[1], 0.0));
    const double most = both.cwiseAbs().sum();
    if (limit.shear < never && most * most >= limit.shear * (std::max(least, 0.0) + tiny)) {
        std::vector<double> p = times(both, both), product = times(weft, warp);
        for (int i = 0; i < 5; ++i)
            p[i] -= limit.shear * product[i];
        p[0] -= limit.shear * tiny;
        step = std::min(step, first_root(p, 1));
    }
    return step;
}

double squared_limit(double stretch) {
    return stretch > 0 ? (1 + stretch) * (1 + stretch) : never;
}

double strain_scale(double largest) {
    return largest == never ? 0 : 0.25 * (largest - 1) * (largest - 1);
}

} // namespace

std::vector<StrainLimit> make_strain_limits(const Garment& garment, const std::vector<Fabric>& fabrics) {
    std::vector<StrainLimit> limits;
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        const Fabric& fabric = fabrics[garment.panel_of_triangle[t]];
        const Mat2& edges = garment.rest.edges[t];
        StrainLimit limit;
        limit.nodes = garment.nodes(t);
        limit.shape.bottomRows<2>() = edges.inverse();
        limit.shape.row(0) = -limit.shape.row(1) - limit.shape.row(2);
        limit.weft = squared_limit(fabric.limit_weft);
        limit.warp = squared_limit(fabric.limit_warp);
        limit.shear = fabric.limit_shear > 0 ? std::pow(std::sin(fabric.limit_shear), 2) : never;
        // As much energy as the membrane holds at the limit: the barrier is about as stiff as the cloth where
        // it begins, and many times as stiff near the limit.
        const double area = 0.5 * std::abs(edges.determinant());
        limit.weft_stiffness = area * fabric.stretch_weft * strain_scale(limit.weft);
        limit.warp_stiffness = area * fabric.stretch_warp * strain_scale(limit.warp);
        limit.shear_stiffness = limit.shear == never ? 0 : area * fabric.shear * limit.shear;
        limits.push_back(limit);
    }
    return limits;
}

int widen_strain_limits(std::vector<StrainLimit>& limits, const Points& x, double margin) {
    int changed = 0;
    for (StrainLimit& limit : limits) {
        const Vec3 c = metric_of(limit, x).c;
        const auto widened = [&](double now, double largest) {
            return std::isfinite(largest) && now > (1 - margin) * largest ? now / (1 - margin) : largest;
        };
        const StrainLimit before = limit;
        limit.weft = 1 + widened(c[0] - 1, limit.weft - 1);
        limit.warp = 1 + widened(c[1] - 1, limit.warp - 1);
        limit.shear = widened(c[2] * c[2] / (c[0] * c[1] + tiny), limit.shear);
        changed += limit.weft != before.weft || limit.warp != before.warp || limit.shear != before.shear;
    }
    return changed;
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

double strain_limit_step(const std::vector<StrainLimit>& limits, const Points& x, const Points& direction,
                         int* where) {
    std::vector<double> steps(limits.size());
    parallel_for(int(limits.size()), chunk, [&](int begin, int end) {
        for (int t = begin; t < end; ++t)
            steps[t] = step_of(limits[t], x, direction);
    });
    const auto least = std::min_element(steps.begin(), steps.end());
    const bool stopped = least != steps.end() && *least < 1;
    if (where) *where = stopped ? int(least - steps.begin()) : -1;
    return stopped ? *least : 1;
}

} // namespace toile
