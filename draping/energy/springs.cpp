// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/springs.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

/// Adds m between the ends of a spring.
void add_between(const Spring& s, const Mat3& m, BlockMatrix& h) {
    h.add_diagonal(s.a, m);
    h.add_diagonal(s.b, m);
    const int row = std::max(s.a, s.b), column = std::min(s.a, s.b);
    h.add_off_diagonal(column, h.find(row, column), -m);
}

} // namespace

double pull(const Spring& s, double distance) {
    const double e = distance - s.length;
    return s.tension + s.stiffness * e + (s.stiffness_beyond - s.stiffness) * std::max(0.0, e - s.threshold);
}

double stiffness(const Spring& s, double distance) {
    return distance - s.length > s.threshold ? s.stiffness_beyond : s.stiffness;
}

double Springs::value(const Points& x) const {
    double sum = 0;
    for (const Spring& s : springs_) {
        const double e = (x[s.b] - x[s.a]).norm() - s.length, beyond = std::max(0.0, e - s.threshold);
        sum += s.tension * e + 0.5 * s.stiffness * e * e + 0.5 * (s.stiffness_beyond - s.stiffness) * beyond * beyond;
    }
    return sum;
}

void Springs::add_gradient(const Points& x, Eigen::VectorXd& g) const {
    for (const Spring& s : springs_) {
        const Vec3 d = x[s.b] - x[s.a];
        const double distance = d.norm();
        if (distance == 0) continue; // it pushes in no direction
        const Vec3 force = pull(s, distance) / distance * d;
        g.segment<3>(3 * s.a) -= force;
        g.segment<3>(3 * s.b) += force;
    }
}

void Springs::couplings(std::vector<std::pair<int, int>>& pairs) const {
    for (const Spring& s : springs_) pairs.emplace_back(s.a, s.b);
}

void Springs::add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const {
    for (const Spring& s : springs_) {
        const Vec3 d = x[s.b] - x[s.a];
        const double distance = d.norm();
        if (distance == 0) continue;
        const Vec3 n = d / distance;
        const Mat3 along = n * n.transpose();
        double across = pull(s, distance) / distance;
        Mat3 m = stiffness(s, distance) * along;
        if (kind == HessianKind::projected) {
            const double flat = s.tension / s.length;
            m += flat * Mat3::Identity();
            across = std::max(0.0, across - flat);
        }
        m += across * (Mat3::Identity() - along);
        add_between(s, m, h);
    }
}

void Springs::add_damping(const Points& x, const Points& v, Eigen::VectorXd& force) const {
    for (const Spring& s : springs_) {
        const Vec3 d = x[s.b] - x[s.a];
        const double squared = d.squaredNorm();
        if (s.damping == 0 || squared == 0) continue;
        const Vec3 f = s.damping * (v[s.b] - v[s.a]).dot(d) / squared * d;
        force.segment<3>(3 * s.a) += f;
        force.segment<3>(3 * s.b) -= f;
    }
}

void Springs::add_damping_matrix(const Points& x, double factor, BlockMatrix& h) const {
    for (const Spring& s : springs_) {
        const Vec3 d = x[s.b] - x[s.a];
        const double squared = d.squaredNorm();
        if (s.damping == 0 || squared == 0) continue;
        add_between(s, factor * s.damping / squared * d * d.transpose(), h);
    }
}

void brace(std::vector<Spring>& springs, SpringBetween& between, const std::vector<BraceNode>& nodes, double c) {
    for (std::size_t i = 0; i < nodes.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const BraceNode &a = nodes[i], &b = nodes[j];
            const double length = (b.place - a.place).norm(), tension = -c * a.weight * b.weight * length;
            const std::array<int, 2> ends{std::min(a.node, b.node), std::max(a.node, b.node)};
            const auto [at, missing] = between.emplace(ends, int(springs.size()));
            if (missing) {
                Spring bend{ends[0], ends[1], length};
                bend.kind = SpringKind::bend;
                springs.push_back(bend);
            }
            Spring& s = springs[at->second];
            s.tension += tension;
            if (s.kind == SpringKind::bend) s.stiffness += std::abs(tension) / length;
        }
}

void damp(std::vector<Spring>& springs, double time) {
    for (Spring& s : springs) s.damping = time * s.stiffness;
}

} // namespace toile
