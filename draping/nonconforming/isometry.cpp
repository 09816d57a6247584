// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/nonconforming/isometry.h"

#include <Eigen/Dense>

#include <algorithm>
#include <stdexcept>

namespace toile {

Bars triangle_bars(const Garment& garment) {
    Bars bars;
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        const Mat2& edges = garment.rest.edges[t];
        const std::array<Vec2, 3> side{edges.col(1) - edges.col(0), edges.col(1), edges.col(0)};
        if (std::abs(edges.determinant()) <= 1e-12 * side[0].squaredNorm())
            throw std::invalid_argument("triangle " + std::to_string(t) +
                                        " has no area, so it cannot keep its shape");
        const auto& e = garment.edges.of_triangle[t];
        for (int k = 0; k < 3; ++k)
            bars.push_back({e[(k + 1) % 3], e[(k + 2) % 3], side[k].norm() / 2});
    }
    return bars;
}

Eigen::VectorXd misfit(const Bars& bars, const Points& x) {
    Eigen::VectorXd c(bars.size());
    for (std::size_t i = 0; i < bars.size(); ++i) {
        const Bar& bar = bars[i];
        const double now = (x[bar.a] - x[bar.b]).norm();
        c[i] = (now - bar.length) * (now + bar.length) / (2 * bar.length);
    }
    return c;
}

double largest_strain(const Bars& bars, const Points& x) {
    const Eigen::VectorXd c = misfit(bars, x);
    double most = 0;
    for (std::size_t i = 0; i < bars.size(); ++i)
        most = std::max(most, std::abs(c[i]) / bars[i].length);
    return most;
}

double largest_triangle_strain(const Garment& garment, const Points& midpoints) {
    double most = 0;
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        const auto& e = garment.edges.of_triangle[t];
        Eigen::Matrix<double, 3, 2> now;
        now << 2 * (midpoints[e[0]] - midpoints[e[1]]), 2 * (midpoints[e[0]] - midpoints[e[2]]);
        const Eigen::Matrix<double, 3, 2> f = now * garment.rest.edges[t].inverse();
        const Mat2 square = f.transpose() * f;
        const Vec2 stretch =
            Eigen::SelfAdjointEigenSolver<Mat2>(square).eigenvalues().cwiseMax(0).cwiseSqrt();
        most = std::max(most, (stretch - Vec2::Ones()).cwiseAbs().maxCoeff());
    }
    return most;
}

void add_tensions(const Bars& bars, const Points& x, const Eigen::VectorXd& lambda, Eigen::VectorXd& g) {
    for (std::size_t i = 0; i < bars.size(); ++i) {
        const Bar& bar = bars[i];
        const Vec3 pull = lambda[i] / bar.length * (x[bar.a] - x[bar.b]);
        g.segment<3>(3 * bar.a) += pull;
        g.segment<3>(3 * bar.b) -= pull;
    }
}

Eigen::VectorXd lengthening(const Bars& bars, const Points& x, const Eigen::VectorXd& d) {
    Eigen::VectorXd c(bars.size());
    for (std::size_t i = 0; i < bars.size(); ++i) {
        const Bar& bar = bars[i];
        c[i] = (x[bar.a] - x[bar.b]).dot(d.segment<3>(3 * bar.a) - d.segment<3>(3 * bar.b)) / bar.length;
    }
    return c;
}

} // namespace toile
