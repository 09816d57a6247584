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

/// Not less than the largest singular value.
double size(const Mat3& m) {
    const double rows = m.cwiseAbs().rowwise().sum().maxCoeff(), columns = m.cwiseAbs().colwise().sum().maxCoeff();
    return std::min(m.norm(), std::sqrt(rows * columns));
}

double row_bound(const BlockMatrix& a, const VectorXd& scale) {
    VectorXd sum = VectorXd::Zero(a.block_rows());
    for (int j = 0; j < a.block_rows(); ++j)
        for (int slot = a.block_columns()[j]; slot < a.block_columns()[j + 1]; ++slot) {
            const int i = a.block_row_indices()[slot];
            const double bound = scale[3 * i] * scale[3 * j] * size(a.block(j, slot));
            sum[i] += bound;
            if (i != j) sum[j] += bound;
        }
    return sum.size() > 0 ? sum.maxCoeff() : 0;
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

template <class Measure>
Fastest measured(NodeProblem& problem, const Points& x, Measure measure) {
    bool changed = false;
    problem.arrive(x);
    BlockMatrix& a = problem.hessian(x, false, changed);
    const VectorXd scale = scaling(problem);
    Fastest f;
    f.stiffness = measure(a, scale);
    a.set_zero();
    problem.add_damping_matrix(x, 1, a);
    f.damping = measure(a, scale);
    return f;
}

} // namespace

double Fastest::step() const {
    return 4 / (damping + std::sqrt(damping * damping + 4 * stiffness));
}

Fastest gershgorin(NodeProblem& problem, const Points& x) { return measured(problem, x, row_bound); }

Fastest lanczos(NodeProblem& problem, const Points& x) { return measured(problem, x, largest); }

} // namespace toile
