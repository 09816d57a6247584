// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/stability.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr int krylov = 40;
constexpr int krylov_kept = 12; // from the fastest motion of a moment before
constexpr double rough = 0.05;  // of what is added to that: motions that have become faster since

/// M^-1/2, 0 for what is pinned.
VectorXd scaling(const NodeProblem& problem) {
    VectorXd s = problem.mass().cwiseSqrt().cwiseInverse();
    for (int i = 0; i < problem.points(); ++i)
        if (problem.pinned()[i]) s.segment<3>(3 * i).setZero();
    return s;
}

/// Rough, or it would miss the fastest motions of a regular mesh; and the same in every run.
VectorXd rough_motion(const VectorXd& scale) {
    VectorXd q(scale.size());
    for (Eigen::Index i = 0; i < q.size(); ++i) q[i] = scale[i] > 0 ? std::sin(1.0 + 12.9898 * double(i * i % 7919)) : 0;
    if (const double norm = q.norm(); norm > 0) q /= norm;
    return q;
}

/// Largest eigenvalue of S A S. `motion` is its eigenvector then, to start from the next time.
double largest(const BlockMatrix& a, const VectorXd& scale, VectorXd& motion) {
    VectorXd q = rough_motion(scale), y;
    const bool kept = motion.size() == q.size();
    if (kept) q = (motion + rough * q).normalized();
    const int most = kept ? krylov_kept : krylov;
    if (q.isZero(0)) return 0;
    std::vector<double> on, off;
    std::vector<VectorXd> basis;
    while (true) {
        a.multiply(scale.cwiseProduct(q), y);
        y = scale.cwiseProduct(y);
        on.push_back(q.dot(y));
        y -= on.back() * q;
        if (!basis.empty()) y -= off.back() * basis.back();
        basis.push_back(q);
        const double left = y.norm();
        if (!(left > 1e-12 * std::abs(on[0])) || int(basis.size()) == most) break;
        off.push_back(left);
        q = y / left;
    }
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    const VectorXd diagonal = Eigen::Map<VectorXd>(on.data(), Eigen::Index(on.size()));
    const VectorXd beside = Eigen::Map<VectorXd>(off.data(), Eigen::Index(on.size()) - 1);
    solver.computeFromTridiagonal(diagonal, beside);
    const Eigen::Index last = diagonal.size() - 1; // eigenvalues rise
    motion.setZero(scale.size());
    for (Eigen::Index k = 0; k <= last; ++k) motion += solver.eigenvectors()(k, last) * basis[k];
    return std::max(0.0, solver.eigenvalues()[last]);
}

} // namespace

double Fastest::step() const { return 4 / (damping + std::sqrt(damping * damping + 4 * stiffness)); }

Fastest fastest(NodeProblem& problem, const Points& x, FastestMotions* from) {
    FastestMotions motions;
    if (!from) from = &motions;
    bool changed = false;
    problem.arrive(x);
    BlockMatrix& a = problem.hessian(x, false, changed);
    const VectorXd scale = scaling(problem);
    Fastest f;
    f.stiffness = largest(a, scale, from->stiffness);
    a.set_zero();
    problem.add_damping_matrix(x, 1, a);
    f.damping = largest(a, scale, from->damping);
    return f;
}

} // namespace toile
