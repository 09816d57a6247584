// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/triangles.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

constexpr double least_length = 1e-6; // of a yarn's image: keeps a collapsed triangle's angle defined
constexpr double least_sine = 1e-9;

/// The cosine between the images, and what its derivatives are made of.
struct Between {
    double length[2];
    Vec3 unit[2];
    double cosine = 0, sine = 1;

    explicit Between(const GrainImages& y) {
        for (int k = 0; k < 2; ++k) {
            length[k] = std::max(y.col(k).norm(), least_length);
            unit[k] = y.col(k) / length[k];
        }
        cosine = unit[0].dot(unit[1]);
        sine = std::max(unit[0].cross(unit[1]).norm(), least_sine);
    }
    double gamma() const { return std::atan2(cosine, sine); }
    GrainSlope cosine_slope() const {
        GrainSlope g;
        g << (unit[1] - cosine * unit[0]) / length[0], (unit[0] - cosine * unit[1]) / length[1];
        return g;
    }
    GrainBend cosine_bend() const {
        const GrainSlope g = cosine_slope();
        GrainBend h;
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

/// Of weft (0) or warp (1) stretched by s, J.
CurveSecants resistance(const CurvedTriangle& t, int c, double s) {
    const double k = c == 0 ? t.weft : t.warp;
    if (!t.curves || (*t.curves)[c].empty()) return {k, k, k};
    const CurveSecants r = secants((*t.curves)[c], s);
    return {t.area * r.by_energy, t.area * r.by_tension, t.area * r.slope};
}

double energy(const CurvedTriangle& t, const GrainImages& y) {
    const Between b(y);
    const double u = b.length[0] - 1, v = b.length[1] - 1, gamma = b.gamma();
    return 0.5 * (resistance(t, 0, u).by_energy * u * u + resistance(t, 1, v).by_energy * v * v + t.shear * gamma * gamma);
}

GrainSlope slope(const CurvedTriangle& t, const GrainImages& y) {
    const Between b(y);
    GrainSlope g = t.shear * b.gamma() / b.sine * b.cosine_slope();
    for (int c = 0; c < 2; ++c) {
        const double s = b.length[c] - 1;
        g.segment<3>(3 * c) += resistance(t, c, s).by_tension * s * b.unit[c];
    }
    return g;
}

/// Projected: yarns under compression without what turns them, and shear without the second derivative of its angle.
GrainBend bend(const CurvedTriangle& t, const GrainImages& y, HessianKind kind) {
    const Between b(y);
    const GrainSlope c = b.cosine_slope();
    GrainBend h = t.shear / (b.sine * b.sine) * c * c.transpose();
    if (kind == HessianKind::exact)
        h += t.shear * b.gamma() *
             (b.cosine_bend() / b.sine + b.cosine / std::pow(b.sine, 3) * c * c.transpose());
    for (int k = 0; k < 2; ++k) {
        double turning = 1 - 1 / b.length[k];
        if (kind == HessianKind::projected) turning = std::max(turning, 0.0);
        const CurveSecants r = resistance(t, k, b.length[k] - 1);
        const Mat3 along = b.unit[k] * b.unit[k].transpose();
        h.block<3, 3>(3 * k, 3 * k) +=
            r.by_tension * (r.slope / r.by_tension * along + turning * (Mat3::Identity() - along));
    }
    return h;
}

/// Adds `share` times the stiffness of a constraint of N nodes times the product of its gradient with itself.
template <int N> void add_product(const Constraint& c, double share, BlockMatrix& h) {
    std::array<int, N> nodes;
    Eigen::Matrix<double, 3 * N, 1> gradient;
    for (int i = 0; i < N; ++i) {
        nodes[i] = c.nodes[i];
        gradient.template segment<3>(3 * i) = c.gradient[i];
    }
    const Eigen::Matrix<double, 3 * N, 3 * N> block = share * c.stiffness * gradient * gradient.transpose();
    h.add_element(nodes, block);
}

} // namespace

TriangleCloth::TriangleCloth(const Garment& garment, const std::vector<Fabric>& fabrics, double damping_time)
    : bends_(make_hinge_bends(garment, fabrics)), damping_time_(damping_time) {
    std::vector<std::shared_ptr<const std::array<StretchCurve, 2>>> curves; // per panel
    for (const Fabric& f : fabrics) {
        curves.emplace_back();
        if (!f.curve_weft.empty() || !f.curve_warp.empty())
            curves.back() = std::make_shared<const std::array<StretchCurve, 2>>(
                std::array{stretch_curve(f.curve_weft), stretch_curve(f.curve_warp)});
    }
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        const int panel = garment.panel_of_triangle[t];
        triangles_.push_back(
            {make_grain_triangle(garment, fabrics[panel], t), rest_area(garment.rest.edges[t]), curves[panel]});
    }
}

double TriangleCloth::value(const Points& x) const {
    double sum = toile::value(bends_, x);
    for (const CurvedTriangle& t : triangles_) sum += energy(t, grain_images(t.nodes, t.shape, x));
    return sum;
}

void TriangleCloth::add_gradient(const Points& x, Eigen::VectorXd& g) const {
    toile::add_gradient(bends_, x, g);
    for (const CurvedTriangle& t : triangles_) {
        const GrainSlope s = slope(t, grain_images(t.nodes, t.shape, x));
        for (int k = 0; k < 3; ++k)
            g.segment<3>(3 * t.nodes[k]) += at_corner(t.shape, s, k);
    }
}

Constraint TriangleCloth::constraint(int k, const Points& x) const {
    if (k >= int(3 * triangles_.size())) return toile::constraint(bends_[k - 3 * triangles_.size()], x);
    const CurvedTriangle& t = triangles_[k / 3];
    const Between b(grain_images(t.nodes, t.shape, x));
    const int which = k % 3;
    GrainSlope s = GrainSlope::Zero();
    Constraint c;
    c.count = 3;
    if (which == 2) {
        c.stiffness = t.shear;
        c.value = b.gamma();
        s = b.cosine_slope() / b.sine;
    } else {
        c.value = b.length[which] - 1;
        c.stiffness = resistance(t, which, c.value).by_tension;
        s.segment<3>(3 * which) = b.unit[which];
    }
    for (int i = 0; i < 3; ++i) {
        c.nodes[i] = t.nodes[i];
        c.gradient[i] = at_corner(t.shape, s, i);
    }
    return c;
}

void TriangleCloth::add_damping(const Points& x, const Points& v, Eigen::VectorXd& force) const {
    if (damping_time_ == 0) return;
    for (int k = 0; k < constraint_count(); ++k) {
        const Constraint c = constraint(k, x);
        double rate = 0;
        for (int i = 0; i < c.count; ++i) rate += c.gradient[i].dot(v[c.nodes[i]]);
        for (int i = 0; i < c.count; ++i) force.segment<3>(3 * c.nodes[i]) -= damping_time_ * c.stiffness * rate * c.gradient[i];
    }
}

void TriangleCloth::add_damping_matrix(const Points& x, double factor, BlockMatrix& h) const {
    if (damping_time_ == 0) return;
    for (int k = 0; k < constraint_count(); ++k) {
        const Constraint c = constraint(k, x);
        if (c.count == 3)
            add_product<3>(c, factor * damping_time_, h);
        else
            add_product<4>(c, factor * damping_time_, h);
    }
}

void TriangleCloth::couplings(std::vector<std::pair<int, int>>& pairs) const {
    toile::couplings(bends_, pairs);
    for (const CurvedTriangle& t : triangles_)
        for (int k = 0; k < 3; ++k) pairs.emplace_back(t.nodes[k], t.nodes[(k + 1) % 3]);
}

void TriangleCloth::add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const {
    toile::add_hessian(bends_, x, kind, h);
    for (const CurvedTriangle& t : triangles_)
        h.add_element(t.nodes, at_corners(t.shape, bend(t, grain_images(t.nodes, t.shape, x), kind)));
}

} // namespace toile
