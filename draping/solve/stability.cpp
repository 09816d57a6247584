// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/stability.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr int krylov = 40;

/// M^-1/2, 0 for what is pinned.
VectorXd scaling(const NodeProblem& problem) {
    VectorXd s = problem.mass().cwiseSqrt().cwiseInverse();
    for (int i = 0; i < problem.points(); ++i)
        if (problem.pinned()[i]) s.segment<3>(3 * i).setZero();
    return s;
}

/// Largest eigenvalue of S A S.
double largest(const BlockMatrix& a, const VectorXd& scale) {
    const Eigen::Index n = scale.size();
    VectorXd q(n), before = VectorXd::Zero(n), y;
    // Rough, or it would miss the fastest motions of a regular mesh; and the same in every run.
    for (Eigen::Index i = 0; i < n; ++i) q[i] = scale[i] > 0 ? std::sin(1.0 + 12.9898 * double(i * i % 7919)) : 0;
    if (q.norm() == 0) return 0;
    q.normalize();
    std::vector<double> on, off;
    for (int k = 0; k < krylov; ++k) {
        a.multiply(scale.cwiseProduct(q), y);
        y = scale.cwiseProduct(y);
        on.push_back(q.dot(y));
        y -= on.back() * q;
        if (k > 0) y -= off.back() * before;
        const double left = y.norm();
        if (!(left > 1e-12 * std::abs(on[0])) || k + 1 == krylov) break;
        off.push_back(left);
        before = q;
        q = y / left;
    }
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    const VectorXd diagonal = Eigen::Map<VectorXd>(on.data(), Eigen::Index(on.size()));
    const VectorXd beside = Eigen::Map<VectorXd>(off.data(), Eigen::Index(on.size()) - 1);
    solver.computeFromTridiagonal(diagonal, beside, Eigen::EigenvaluesOnly);
    return std::max(0.0, solver.eigenvalues().maxCoeff());
}

} // namespace

double Fastest::step() const { return 4 / (damping + std::sqrt(damping * damping + 4 * stiffness)); }

Fastest fastest(NodeProblem& problem, const Points& x) {
    bool changed = false;
    problem.arrive(x);
    BlockMatrix& a = problem.hessian(x, false, changed);
    const VectorXd scale = scaling(problem);
    Fastest f;
    f.stiffness = largest(a, scale);
    a.set_zero();
    problem.add_damping_matrix(x, 1, a);
    f.damping = largest(a, scale);
    return f;
}

} // namespace toile
