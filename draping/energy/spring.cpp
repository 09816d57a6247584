// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/spring.h"

namespace toile {

namespace {

// Energy of a pull s = k d up to the cap, constant beyond (Huber).
double energy(double d, double k, double cap) { return k * d <= cap ? 0.5 * k * d * d : cap * (d - 0.5 * cap / k); }
double pull_over_length(double d, double k, double cap) { return k * d <= cap ? k : cap / d; }

// Second derivative of the energy over the vector d.
Mat3 stiffness(const Vec3& d, double k, double cap) {
    const double length = d.norm();
    if (k * length <= cap) return k * Mat3::Identity();
    const Vec3 n = d / length;
    return cap / length * (Mat3::Identity() - n * n.transpose());
}

struct Ends {
    std::array<int, 3> node;
    std::array<double, 3> weight;
    int count;
};

Ends ends(const StitchSpring& s) {
    if (s.r == 0) return {{s.a, s.b[0], s.b[0]}, {1, -1, 0}, 2};
    return {{s.a, s.b[0], s.b[1]}, {1, s.r - 1, -s.r}, 3};
}

Vec3 gap(const Ends& e, const Points& x) {
    Vec3 d = Vec3::Zero();
    for (int k = 0; k < e.count; ++k) d += e.weight[k] * x[e.node[k]];
    return d;
}

Vec3 gap(const HookSpring& s, const Points& x) { return s.axes.cwiseProduct(x[s.node] - s.place); }

} // namespace

double value(const std::vector<StitchSpring>& springs, const Points& x) {
    double sum = 0;
    for (const auto& s : springs) sum += energy(gap(ends(s), x).norm(), s.stiffness, s.cap);
    return sum;
}

void add_gradient(const std::vector<StitchSpring>& springs, const Points& x, Eigen::VectorXd& g) {
    for (const auto& s : springs) {
        const Ends e = ends(s);
        const Vec3 d = gap(e, x);
        const Vec3 pull = pull_over_length(d.norm(), s.stiffness, s.cap) * d;
        for (int k = 0; k < e.count; ++k) g.segment<3>(3 * e.node[k]) += e.weight[k] * pull;
    }
}

void add_hessian(const std::vector<StitchSpring>& springs, const Points& x, BlockMatrix& h) {
    for (const auto& s : springs) {
        const Ends e = ends(s);
        const Mat3 m = stiffness(gap(e, x), s.stiffness, s.cap);
        for (int i = 0; i < e.count; ++i) {
            h.add_diagonal(e.node[i], e.weight[i] * e.weight[i] * m);
            for (int j = 0; j < i; ++j) {
                const int row = std::max(e.node[i], e.node[j]), column = std::min(e.node[i], e.node[j]);
                h.add_off_diagonal(column, h.find(row, column), e.weight[i] * e.weight[j] * m);
            }
        }
    }
}

void couplings(const std::vector<StitchSpring>& springs, std::vector<std::pair<int, int>>& pairs) {
    for (const auto& s : springs) {
        const Ends e = ends(s);
        for (int i = 0; i < e.count; ++i)
            for (int j = 0; j < i; ++j) pairs.emplace_back(e.node[i], e.node[j]);
    }
}

double value(const std::vector<HookSpring>& springs, const Points& x) {
    double sum = 0;
    for (const auto& s : springs) sum += energy(gap(s, x).norm(), s.stiffness, s.cap);
    return sum;
}

void add_gradient(const std::vector<HookSpring>& springs, const Points& x, Eigen::VectorXd& g) {
    for (const auto& s : springs) {
        const Vec3 d = gap(s, x);
        g.segment<3>(3 * s.node) += pull_over_length(d.norm(), s.stiffness, s.cap) * d;
    }
}

void add_hessian(const std::vector<HookSpring>& springs, const Points& x, BlockMatrix& h) {
    for (const auto& s : springs) {
        const Mat3 held = s.axes.asDiagonal();
        h.add_diagonal(s.node, held * stiffness(gap(s, x), s.stiffness, s.cap) * held);
    }
}

} // namespace toile
