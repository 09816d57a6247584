// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/fast_projection.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr double yielding = 1e-9;    // of a constraint's own entry: keeps dependent constraints solvable
constexpr double longest_move = 0.5; // of the shortest length, in an iteration

bool moves(const LengthConstraint& c, const std::vector<Mat3>& mobility) {
    return !mobility[c.a].isZero(0) || !mobility[c.b].isZero(0);
}

} // namespace

FastProjection::FastProjection(int points, std::vector<LengthConstraint> constraints) : constraints_(std::move(constraints)) {
    const int n = int(constraints_.size());
    std::vector<std::vector<std::pair<int, double>>> at(points); // constraints of a point, ascending, and their sign there
    shortest_ = n > 0 ? constraints_[0].length : 0;
    for (int k = 0; k < n; ++k) {
        at[constraints_[k].a].emplace_back(k, -1.0);
        at[constraints_[k].b].emplace_back(k, 1.0);
        shortest_ = std::min(shortest_, constraints_[k].length);
    }
    std::vector<Eigen::Triplet<double>> pattern;
    for (int p = 0; p < points; ++p)
        for (std::size_t i = 0; i < at[p].size(); ++i)
            for (std::size_t j = 0; j <= i; ++j) {
                entries_.push_back({at[p][i].first, at[p][j].first, p, at[p][i].second * at[p][j].second, 0});
                pattern.emplace_back(at[p][i].first, at[p][j].first, 0.0);
            }
    matrix_.resize(n, n);
    matrix_.setFromTriplets(pattern.begin(), pattern.end());
    for (Entry& e : entries_) {
        const int *begin = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[e.column],
                  *end = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[e.column + 1];
        e.slot = int(std::lower_bound(begin, end, e.row) - matrix_.innerIndexPtr());
    }
    if (n > 0) factor_.analyzePattern(matrix_);
}

bool FastProjection::solve(const std::vector<Mat3>& mobility, double dt, const Points& at, VectorXd violation,
                           const std::vector<double>& tension, VectorXd& change) {
    double* value = matrix_.valuePtr();
    std::fill(value, value + matrix_.nonZeros(), 0.0);
    for (const Entry& e : entries_)
        value[e.slot] += dt * dt * e.sign *
                         slope(constraints_[e.row], at).dot(mobility[e.point] * slope(constraints_[e.column], at));
    for (int k = 0; k < matrix_.cols(); ++k) {
        double& own = value[matrix_.outerIndexPtr()[k]];
        if (moves(constraints_[k], mobility)) {
            violation[k] -= yielding * own * tension[k];
            own *= 1 + yielding;
        } else {
            violation[k] = 0;
            own = 1;
        }
    }
    factor_.factorize(matrix_);
    if (factor_.info() != Eigen::Success) return false;
    change = factor_.solve(violation);
    return change.allFinite();
}

Points FastProjection::motion(const std::vector<Mat3>& mobility, double dt, const Points& at, const VectorXd& change) const {
    Points force(at.size(), Vec3::Zero());
    for (std::size_t k = 0; k < constraints_.size(); ++k) {
        const Vec3 pull = change[k] * slope(constraints_[k], at);
        force[constraints_[k].a] += pull;
        force[constraints_[k].b] -= pull;
    }
    for (std::size_t i = 0; i < force.size(); ++i) force[i] = dt * dt * mobility[i] * force[i];
    return force;
}

ProjectionDone FastProjection::project(const std::vector<Mat3>& mobility, double dt, const std::vector<double>& lengths,
                                       const Points& start, Points& x, std::vector<double>& tension) {
    const int n = int(constraints_.size());
    const std::vector<double> before = tension;
    ProjectionDone done;
    VectorXd c(n), change;
    const auto advance = [&](const Points& at) {
        if (!solve(mobility, dt, at, c, tension, change)) return false;
        ++done.iterations;
        Points move = motion(mobility, dt, at, change);
        double farthest = 0;
        for (const Vec3& m : move) farthest = std::max(farthest, m.norm());
        const double share = std::min(1.0, longest_move * shortest_ / std::max(farthest, 1e-300));
        for (std::size_t i = 0; i < x.size(); ++i) x[i] += share * move[i];
        for (int k = 0; k < n; ++k) tension[k] += share * change[k];
        return true;
    };
    const auto largest_strain = [&] {
        double largest = 0;
        for (int k = 0; k < n; ++k)
            if (moves(constraints_[k], mobility))
                largest = std::max(largest, std::abs((x[constraints_[k].b] - x[constraints_[k].a]).norm() / lengths[k] - 1));
        return largest;
    };

    for (int k = 0; k < n; ++k) {
        const auto& [a, b, length] = constraints_[k];
        c[k] = violation(constraints_[k], lengths[k], start) +
               slope(constraints_[k], start).dot((x[b] - start[b]) - (x[a] - start[a]));
    }
    bool goes_on = n > 0 && advance(start);
    done.strain = largest_strain();
    Points best = x;
    while (goes_on && done.strain > options.tolerance && done.iterations < options.max_iterations) {
        for (int k = 0; k < n; ++k) c[k] = violation(constraints_[k], lengths[k], x);
        goes_on = advance(Points(x));
        const double now = largest_strain();
        if (!(now < done.strain)) continue; // may come back
        done.strain = now;
        best = x;
    }
    x = std::move(best);
    done.converged = done.strain <= options.tolerance;
    if (!done.converged) tension = before; // of lengths that cannot be had they would grow without end
    return done;
}

} // namespace toile
