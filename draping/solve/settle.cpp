// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/settle.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr int direct_below = 300;  // points: a factorisation is cheaper than keeping one
constexpr int cg_patience = 6;     // iterations after which a kept factor is too old
constexpr double cg_tolerance = 0.1;
constexpr int tail_cg_limit = 60;
constexpr double tail_patience = 10;
constexpr double first_radius = 2; // steps of the projected matrix, which is too stiff by such a factor
constexpr int old_factor_cg = 25;  // CG iterations after which the factor is renewed
constexpr double worth_parting = 0.9; // share of a step below which every point goes as far as it can by itself
constexpr double sufficient = 1e-4;   // of the decrease that the slope promises
constexpr double static_time_step = 100; // s: from there on steps are Newton's
constexpr double most_time_step = 1e6;   // s: no mass is left, but some steps shorter a loose piece has one again
constexpr double too_stiff = 1.2;        // gain over what was promised from which longer steps are looked for
constexpr int relax_every = 2;       // steps of the whole, between those of a part
constexpr double tail_time_step = 1; // s: before that the state is still travelling, however small the forces

double longest(const VectorXd& dx) {
    double most = 0;
    for (Eigen::Index i = 0; i < dx.size(); i += 3) most = std::max(most, dx.segment<3>(i).squaredNorm());
    return std::sqrt(most);
}

void move(Points& x, const VectorXd& dx, double t) { flat(x) += t * dx; }

struct Run {
    Problem& problem;
    Cholesky& factor;
    const SettleOptions& options;
    SettleResult result;
    bool analysed = false, factored = false;

    void analyse_if(bool pattern_changed, const BlockMatrix& h) {
        if (analysed && !pattern_changed) return;
        factor.analyse(h, analysed);
        analysed = true;
        factored = false;
    }

    bool factorise_preconditioner(const BlockMatrix& h) {
        ++result.factorisations;
        return factored = factor.factorise_preconditioner(h);
    }

    bool solve_directly(const BlockMatrix& h, const VectorXd& g, VectorXd& dx) {
        ++result.factorisations;
        factored = factor.factorise(h);
        if (!factored) return false;
        factor.solve(-g, dx);
        return true;
    }

    /// Solves h dx = -g by conjugate gradients preconditioned with the kept factor. False when it takes too long.
    bool solve_with_kept(const BlockMatrix& h, const VectorXd& g, VectorXd& dx) {
        VectorXd r = -g, z, p, hp;
        dx.setZero(g.size());
        factor.precondition(r, z);
        p = z;
        double rz = r.dot(z);
        const double stop = cg_tolerance * cg_tolerance * rz;
        for (int k = 0; k < cg_patience; ++k) {
            ++result.conjugate_gradients;
            h.multiply(p, hp);
            const double curvature = p.dot(hp);
            if (!(curvature > 0)) return false;
            const double a = rz / curvature;
            dx += a * p;
            r -= a * hp;
            factor.precondition(r, z);
            const double next = r.dot(z);
            if (next <= stop) return true;
            p = z + (next / rz) * p;
            rz = next;
        }
        return false;
    }

    bool direction(const BlockMatrix& h, const VectorXd& g, VectorXd& dx) {
        if (problem.points() < direct_below) return solve_directly(h, g, dx);
        if (factored && solve_with_kept(h, g, dx)) return true;
        if (!factorise_preconditioner(h)) return false;
        return solve_with_kept(h, g, dx) || solve_directly(h, g, dx);
    }

    /// The energy when all go a share of the way d.
    double value_at(const Points& x, const VectorXd& d, double share) {
        Points trial = x;
        move(trial, d, share);
        return problem.value(trial);
    }

    /// One pair in the way need not hold up all the cloth: lets every point go its own share of the way. Returns the
    /// share of the new dx that is feasible, or 0 and dx as it was when going t of the whole is as good.
    double part(const Points& x, const VectorXd& g, const std::vector<double>& shares, double t, VectorXd& dx) {
        VectorXd parted = dx;
        for (std::size_t i = 0; i < shares.size(); ++i) parted.segment<3>(3 * i) *= shares[i];
        const double slope = g.dot(parted);
        if (!(slope < 0)) return 0;
        double feasible = problem.feasible_step(x, parted);
        const double whole = value_at(x, dx, t);
        for (int cut = 0; cut < 3; ++cut, feasible *= 0.5) {
            const double value = value_at(x, parted, feasible);
            if (value >= whole || value > result.energy + sufficient * feasible * slope) continue;
            dx = std::move(parted);
            return feasible;
        }
        return 0;
    }

    /// The projected matrix is several times too stiff for slow, long waves, and successive steps go the same way:
    /// takes the best step of the plane of dx and of the last motion, by the true second derivative along both, when
    /// it is feasible and better than dx, or a part of the way to it (Narkiss and Zibulevsky, Sequential subspace
    /// optimization, 2005). All of dx is feasible.
    void lengthen(const Points& x, const VectorXd& g, const VectorXd& last, VectorXd& dx) {
        VectorXd hd, hp;
        problem.curvature_along(x, g, dx, hd);
        problem.curvature_along(x, g, last, hp);
        Mat2 h;
        h << dx.dot(hd), dx.dot(hp), dx.dot(hp), last.dot(hp);
        const Vec2 slope(g.dot(dx), g.dot(last));
        if (!(h(0, 0) > 0 && h.determinant() > 1e-3 * h(0, 0) * h(1, 1))) return;
        const Vec2 best = -h.inverse() * slope;
        if (best[0] < 1) return;
        const VectorXd further = (best[0] - 1) * dx + best[1] * last;
        const double plain = value_at(x, dx, 1);
        for (const double share : {1.0, 0.5, 0.25}) {
            VectorXd d = dx + share * further;
            if (longest(d) > options.max_step || problem.feasible_step(x, d) < 1 || value_at(x, d, 1) >= plain) continue;
            dx = std::move(d);
            return;
        }
    }

    /// Minimises g.d + d.H d / 2 within |d| <= radius, in the norm of the kept factor. Returns whether the
    /// boundary was reached; `iterations` receives the CG iterations taken.
    bool trust_region_direction(const VectorXd& g, double radius, double tolerance, VectorXd& d,
                                int& iterations) {
        d.setZero(g.size());
        VectorXd r = -g, z, p, hp;
        factor.precondition(r, z);
        p = z;
        double rz = r.dot(z);
        const double stop = tolerance * tolerance * rz;
        double dd = 0, dp = 0, pp = rz; // inner products in the factor's norm
        const auto to_boundary = [&] {
            const double t = (-dp + std::sqrt(dp * dp + pp * (radius * radius - dd))) / pp;
            d += t * p;
            return true;
        };
        for (iterations = 1; iterations <= tail_cg_limit; ++iterations) {
            ++result.conjugate_gradients;
            problem.multiply(p, hp);
            const double curvature = p.dot(hp);
            if (!(curvature > 0)) return to_boundary();
            const double a = rz / curvature;
            if (dd + 2 * a * dp + a * a * pp >= radius * radius) return to_boundary();
            d += a * p;
            dd += 2 * a * dp + a * a * pp;
            r -= a * hp;
            factor.precondition(r, z);
            const double next = r.dot(z);
            if (next <= stop) return false;
            const double beta = next / rz;
            dp = beta * (dp + a * pp);
            pp = next + beta * beta * pp;
            p = z + beta * p;
            rz = next;
        }
        return false;
    }
};

} // namespace

SettleResult settle(Problem& problem, Points& x, Cholesky& factor, const SettleOptions& options) {
    Run run{problem, factor, options, {}, false, false};
    SettleResult& result = run.result;
    VectorXd g, dx, hdx, shift, last;
    double h = options.time_step;
    double radius = 0; // of the trust region, 0 while not in the tail
    int failures = 0, whole_steps = 0;
    double gained = 0; // by the last step, as a share of what the matrix promised
    bool still = false, tail = false, stale = false;
    std::vector<double> shares;

    problem.arrive(x);
    for (;; ++result.iterations) {
        result.energy = problem.value(x);
        problem.gradient(x, g);
        result.residual = problem.residual(x, g);
        if (options.progress && !options.progress(result.iterations, result.residual)) {
            result.end = SettleEnd::stopped;
            return result;
        }
        if (result.residual <= options.tolerance || (still && result.residual <= options.still_below)) {
            result.end = SettleEnd::settled;
            return result;
        }
        if (result.iterations >= options.max_iterations) {
            result.end = SettleEnd::iterations;
            return result;
        }

        // Once in the tail a passing rise of the residual is no reason to leave it.
        const double exact_below = (tail ? tail_patience : 1) * options.exact_below;
        tail = result.residual < exact_below && run.analysed && h > tail_time_step;
        if (!tail) radius = 0;
        bool pattern_changed = false, boundary = false;
        int cg = 0;
        shift = problem.mass() / (h * h);
        const auto prepared = [&](bool exact) -> BlockMatrix& {
            BlockMatrix& m = problem.hessian(x, exact, pattern_changed);
            m.add_to_diagonal(exact ? VectorXd(problem.mass() / 100.0) : shift);
            m.pin(problem.pinned());
            return m;
        };
        bool solved = true;
        if (tail) {
            BlockMatrix* m = radius > 0 && !stale ? &prepared(true) : nullptr;
            if (!m || pattern_changed) { // the factor of the projected matrix is the norm of the trust region
                m = &prepared(false);
                run.analyse_if(pattern_changed, *m);
                solved = run.factorise_preconditioner(*m);
                if (solved && radius == 0) {
                    factor.precondition(-g, dx);
                    radius = first_radius * std::sqrt(-g.dot(dx));
                }
                m = &prepared(true);
            }
            if (solved)
                boundary = run.trust_region_direction(g, radius, std::min(0.1, std::sqrt(result.residual)), dx, cg);
            stale = cg > old_factor_cg;
        } else {
            BlockMatrix& m = prepared(false);
            run.analyse_if(pattern_changed, m);
            solved = run.direction(m, g, dx);
        }
        if (!solved) {
            h *= 0.25;
            radius = 0;
            if (++failures > 12) {
                result.end = SettleEnd::stalled;
                return result;
            }
            continue;
        }

        const double reach = longest(dx);
        if (reach > options.max_step) dx *= options.max_step / reach;
        double t = problem.feasible_step(x, dx, &shares);
        if (t < worth_parting) {
            if (const double own = run.part(x, g, shares, t, dx); own > 0) t = own;
        } else if (t == 1 && !tail && h > static_time_step && reach < options.max_step && gained > too_stiff) {
            run.lengthen(x, g, last, dx);
        }
        const double feasible = t;
        const double slope = g.dot(dx);
        problem.multiply(dx, hdx);
        const double bend = dx.dot(hdx);

        const double noise = 1e-13 * (1 + std::abs(result.energy)); // below it energies do not tell steps apart
        double actual = 0, predicted = 0;
        bool accepted = false;
        for (int cut = 0; cut < 12 && t > 1e-12; ++cut) {
            predicted = -(t * slope + 0.5 * t * t * bend);
            Points trial = x;
            move(trial, dx, t);
            const double value = problem.value(trial);
            actual = result.energy - value;
            if (actual >= sufficient * -t * slope || (predicted < noise && actual > -noise)) {
                last = t * dx;
                x = std::move(trial);
                accepted = true;
                break;
            }
            t *= 0.5;
        }
        const double ratio = predicted > noise ? actual / predicted : accepted ? 1 : 0;
        gained = accepted ? ratio : 0;
        if (radius > 0) {
            if (!accepted || t < feasible || ratio < 0.25)
                radius *= 0.4;
            else if (ratio > 0.75 && boundary)
                radius *= 2.5;
        } else if (accepted && t == feasible && ratio > 0.5) {
            h = std::min(2 * h, most_time_step);
        } else if (!accepted || ratio < 0.1) {
            h *= 0.5;
        }
        if (!accepted) {
            if (++failures > 12) {
                result.end = SettleEnd::stalled;
                return result;
            }
        } else {
            failures = 0;
            result.motion = longest(last);
            still = options.still > 0 && t == 1 && result.motion < options.still && h > 1;
            problem.arrive(x);
            if (options.relax_part && h > static_time_step && ++whole_steps % relax_every == 0 &&
                options.relax_part(x, last, result.residual))
                problem.arrive(x);
        }
    }
}

} // namespace toile
