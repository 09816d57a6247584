// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/nonconforming/step_solver.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>

namespace toile {

namespace {

using Eigen::VectorXd;
using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

constexpr int most_restores = 8;
constexpr double restore_rate = 0.7; // misfit has to shrink by, or the linearisation is spent

VectorXd scalar_product(const Eigen::SparseMatrix<double>& a, const VectorXd& x) {
    const Coordinates y = a * Eigen::Map<const Coordinates>(x.data(), a.rows(), 3);
    return Eigen::Map<const VectorXd>(y.data(), y.size());
}

/// W of one linearisation.
struct Operator {
    const StepProblem& p;
    const Bars& bars;
    const VectorXd& tension;
    bool pushes = true; ///< bars that push count; without them W is positive

    double turning(std::size_t bar) const { return (pushes ? tension[bar] : pull(bar)) / bars[bar].length; }
    double pull(std::size_t bar) const { return std::max(tension[bar], 0.0); }

    VectorXd product(const VectorXd& d) const {
        VectorXd w = linear(d);
        for (std::size_t i = 0; i < bars.size(); ++i) {
            const Bar& bar = bars[i];
            const Vec3 turned = turning(i) * (d.segment<3>(3 * bar.a) - d.segment<3>(3 * bar.b));
            w.segment<3>(3 * bar.a) += turned;
            w.segment<3>(3 * bar.b) -= turned;
        }
        return w;
    }

    /// Of all but the bars.
    VectorXd gradient(const VectorXd& x) const {
        const VectorXd start = flat(p.start);
        VectorXd g = linear(x - start) + scalar_product(p.problem.stiffness, start) - flat(p.load);
        for (std::size_t e = 0; e < p.inertia.size(); ++e) g.segment<3>(3 * e) += p.inertia[e] * p.start[e];
        return g;
    }

    /// What does not depend on tensions.
    VectorXd linear(const VectorXd& d) const {
        VectorXd w = scalar_product(p.problem.stiffness, d);
        for (std::size_t e = 0; e < p.inertia.size(); ++e) w.segment<3>(3 * e) += p.inertia[e] * d.segment<3>(3 * e);
        if (!p.ghost_stiffness) return w;
        const VectorXd nodes = flat(ghost_nodes(p.midpoints, points(d)));
        VectorXd forces;
        p.ghost_stiffness->multiply(nodes, forces);
        return w + flat(from_ghost_nodes(p.midpoints, points(forces)));
    }

    /// Without what bars that push take from it.
    std::vector<Mat3> diagonal() const {
        std::vector<Mat3> a(p.inertia.size());
        for (std::size_t e = 0; e < a.size(); ++e)
            a[e] = (p.inertia[e] + p.problem.stiffness.coeff(e, e)) * Mat3::Identity();
        for (std::size_t i = 0; i < bars.size(); ++i)
            for (int e : {bars[i].a, bars[i].b}) a[e] += pull(i) / bars[i].length * Mat3::Identity();
        if (p.ghost_stiffness) add_ghost_diagonal(a);
        return a;
    }

    void add_ghost_diagonal(std::vector<Mat3>& a) const {
        const BlockMatrix& h = *p.ghost_stiffness;
        const auto& ghost = p.midpoints.ghost;
        for (int i = 0; i < h.block_rows(); ++i) {
            Mat3 own = Mat3::Zero();
            for (int c = 0; c < 3; ++c)
                for (int r = c; r < 3; ++r) own(r, c) = own(c, r) = h.values()[h.scalar_columns()[3 * i + c] + r - c];
            if (own.isZero(0)) continue;
            for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator e(ghost, i); e; ++e)
                a[e.col()] += e.value() * e.value() * own;
        }
    }

    static Points points(const VectorXd& d) {
        Points x(d.size() / 3);
        flat(x) = d;
        return x;
    }
};

struct Linear {
    VectorXd d, multipliers; ///< multipliers in place of those that stood in the residual
    int iterations = 0;
};

double longest(const VectorXd& v, const std::vector<char>& held) {
    double most = 0;
    for (std::size_t i = 0; i < held.size(); ++i)
        if (!held[i]) most = std::max(most, v.segment<3>(3 * i).norm());
    return most;
}

/// Goes as a whole as far as lowers the energy, the residual r with it: the momentum of what nothing holds is kept to the last
/// digits, whatever conjugate gradients leave.
void go_as_a_whole(const Operator& w, VectorXd& r, VectorXd& d) {
    Vec3 force = Vec3::Zero();
    for (Eigen::Index e = 0; e < r.size(); e += 3) force += r.segment<3>(e);
    if (force.isZero(0)) return;
    const VectorXd p = force.replicate(r.size() / 3, 1), wp = w.product(p);
    const double step = -r.dot(p) / p.dot(wp);
    d += step * p;
    r += step * wp;
}

/// W d + J^T y = -g, J d = -c. Nothing when W is not positive along motions that change no length.
std::optional<Linear> solve(const Operator& w, IsometryDual& dual, const VectorXd& g, const VectorXd& c,
                            const std::vector<char>& held, bool loose, const StepSolverOptions& o) {
    Linear s;
    // The shortest way to the lengths, then on from there along motions that keep them.
    s.d = -dual.mobile(dual.transpose_product(dual.multipliers(c)));
    s.multipliers = VectorXd::Zero(c.size());
    VectorXd r = g + w.product(s.d), z;
    if (loose) go_as_a_whole(w, r, s.d);
    const auto project = [&] {
        // The residual is that less the bars' part, which would drown the rest in its rounding.
        const VectorXd y = dual.multipliers(dual.product(dual.mobile(r)));
        r -= dual.transpose_product(y);
        s.multipliers -= y;
        z = dual.mobile(r);
    };
    project();
    VectorXd p = -z;
    double rz = r.dot(z);
    const double enough = std::max(0.3 * o.tolerance, o.linear * longest(r, held));
    while (s.iterations < o.max_linear && rz > 0 && longest(r, held) > enough) {
        const VectorXd wp = w.product(p);
        const double curvature = p.dot(wp);
        if (!(curvature > 0)) return {};
        const double step = rz / curvature;
        s.d += step * p;
        r += step * wp;
        ++s.iterations;
        project();
        const double next = r.dot(z);
        p = next / rz * p - z;
        rz = next;
    }
    if (loose) go_as_a_whole(w, r, s.d);
    return s;
}

double worst_strain(const Bars& bars, const VectorXd& c) {
    double most = 0;
    for (std::size_t i = 0; i < bars.size(); ++i) most = std::max(most, std::abs(c[i]) / bars[i].length);
    return most;
}

Vec3 moment(const std::vector<double>& mass, const Points& x) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t e = 0; e < x.size(); ++e) sum += mass[e] * x[e];
    return sum;
}

} // namespace

StepSolver::StepSolver(const IsometricProblem& problem, const std::vector<HeldPlace>& places)
    : dual_(int(problem.held.size()), problem.bars, places), held_(problem.held),
      loose_(places.empty() && std::find(held_.begin(), held_.end(), 1) == held_.end()) {}

bool StepSolver::factorise(const std::vector<Mat3>& diagonal) {
    std::vector<Mat3> mobility(diagonal.size(), Mat3::Zero());
    for (std::size_t e = 0; e < mobility.size(); ++e)
        if (!held_[e]) mobility[e] = diagonal[e].inverse();
    return dual_.factorise(mobility);
}

void StepSolver::restore(const StepProblem& p, Points& x, double strain) {
    VectorXd c = misfits(p, x);
    const Vec3 centre = moment(p.inertia, x);
    double now = worst_strain(dual_.bars(), c);
    for (int i = 0; i < most_restores && now > strain; ++i) {
        const double last = now;
        flat(x) -= dual_.mobile(dual_.transpose_product(dual_.multipliers(c)));
        c = misfits(p, x);
        now = worst_strain(dual_.bars(), c);
        if (!(now < restore_rate * last)) break;
    }
    if (!loose_) return;
    const Vec3 back = (centre - moment(p.inertia, x)) / std::accumulate(p.inertia.begin(), p.inertia.end(), 0.0);
    for (Vec3& q : x) q += back;
}

VectorXd StepSolver::misfits(const StepProblem& p, const Points& x) const {
    VectorXd c = dual_.product(flat(x) - flat(p.start)); // of places alone: they are linear
    c.head(p.slack.size()) = misfit(dual_.bars(), x) - p.slack;
    return c;
}

VectorXd StepSolver::pulls(const Points& x, const VectorXd& tension) {
    dual_.linearise(x);
    return dual_.transpose_product(tension);
}

IsometricResult StepSolver::step(const StepProblem& p, Points& x, VectorXd& tension, const StepSolverOptions& o) {
    IsometricResult result;
    const int before = dual_.factorisations();
    if (tension.size() != dual_.conditions()) tension.setZero(dual_.conditions());
    for (;; ++result.iterations) {
        dual_.linearise(x);
        Operator w{p, dual_.bars(), tension};
        const VectorXd balance = w.gradient(flat(x)) + dual_.transpose_product(tension), c = misfits(p, x);
        result.residual = longest(balance, held_);
        result.strain = worst_strain(dual_.bars(), c);
        if (result.residual <= o.tolerance && result.strain <= o.strain) {
            result.end = IsometricEnd::settled;
            break;
        }
        if (result.iterations >= o.max_iterations) break;
        if (!std::isfinite(result.residual + result.strain) || !factorise(w.diagonal()))
            throw std::runtime_error("the motion of the cloth is no longer finite");
        std::optional<Linear> s = solve(w, dual_, balance, c, held_, loose_, o);
        if (!s) {
            w.pushes = false;
            s = solve(w, dual_, balance, c, held_, loose_, o);
        }
        if (!s) throw std::runtime_error("the motion of the cloth has no finite stiffness");
        linear_iterations_ += s->iterations;
        flat(x) += s->d;
        tension += s->multipliers;
        restore(p, x, o.strain);
    }
    result.factorisations = dual_.factorisations() - before;
    return result;
}

} // namespace toile
