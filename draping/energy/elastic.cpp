// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/elastic.h"

namespace toile {

double strain(const ElasticSegment& s, const Points& x) {
    return (x[s.b] - x[s.a]).norm() / s.rest - 1;
}

double value(const std::vector<ElasticSegment>& segments, const Points& x) {
    double sum = 0;
    for (const ElasticSegment& s : segments) {
        const double e = std::max(0.0, strain(s, x));
        sum += 0.5 * s.stiffness * s.rest * e * e;
    }
    return sum;
}

void add_gradient(const std::vector<ElasticSegment>& segments, const Points& x, Eigen::VectorXd& g) {
    for (const ElasticSegment& s : segments) {
        const double e = strain(s, x);
        if (e <= 0) continue;
        const Vec3 pull = s.stiffness * e * (x[s.b] - x[s.a]).normalized();
        g.segment<3>(3 * s.a) -= pull;
        g.segment<3>(3 * s.b) += pull;
    }
}

void add_hessian(const std::vector<ElasticSegment>& segments, const Points& x, BlockMatrix& h) {
    for (const ElasticSegment& s : segments) {
        const double e = strain(s, x);
        if (e <= 0) continue;
        const Vec3 d = x[s.b] - x[s.a], n = d.normalized();
        const Mat3 along = n * n.transpose();
        const Mat3 m = s.stiffness / s.rest * along + s.stiffness * e / d.norm() * (Mat3::Identity() - along);
        h.add_diagonal(s.a, m);
        h.add_diagonal(s.b, m);
        const int row = std::max(s.a, s.b), column = std::min(s.a, s.b);
        h.add_off_diagonal(column, h.find(row, column), -m);
    }
}

void couplings(const std::vector<ElasticSegment>& segments, std::vector<std::pair<int, int>>& pairs) {
    for (const ElasticSegment& s : segments)
        pairs.emplace_back(s.a, s.b);
}

} // namespace toile
