// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/nonconforming/rest.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

using Eigen::VectorXd;

constexpr int most_restores = 30;
constexpr double restore_rate =
    0.7; // misfit may shrink no slower, or the step was too long for its linearisation
constexpr double sufficient = 1e-4; // of the decrease that the slope promises
constexpr double first_shift = 1e-7, shift_growth = 8, shift_decay = 0.2,
                 most_shift = 1e3; // of the mean diagonal
constexpr int longest_wait = 7;
constexpr double too_stiff = 1.5; // gain over what was promised from which longer steps are looked for
constexpr double rounding = 1e-15;
constexpr double near_enough = 0.01; // strain
constexpr double restoring_shift = 1e-9;

VectorXd product(const Eigen::SparseMatrix<double>& a, const VectorXd& x) {
    using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
    const Coordinates y = a * Eigen::Map<const Coordinates>(x.data(), a.rows(), 3);
    return Eigen::Map<const VectorXd>(y.data(), y.size());
}

double strain_of(const Bars& bars, const VectorXd& c) {
    double most = 0;
    for (std::size_t i = 0; i < bars.size(); ++i)
        most = std::max(most, std::abs(c[i]) / bars[i].length);
    return most;
}

double longest(const VectorXd& v, const std::vector<char>& held) {
    double most = 0;
    for (std::size_t i = 0; i < held.size(); ++i)
        if (!held[i]) most = std::max(most, v.segment<3>(3 * i).norm());
    return most;
}

/// Share of d, at most 1, that turns no bar by more than `turn`.
double within_turn(const Bars& bars, const VectorXd& d, double turn) {
    double most = 0;
    for (const Bar& bar : bars)
        most = std::max(most, (d.segment<3>(3 * bar.a) - d.segment<3>(3 * bar.b)).norm() / bar.length);
    return most > turn ? turn / most : 1;
}

struct Descent {
    Saddle& saddle;
    const IsometricProblem& problem;
    const IsometricOptions& options;
    double diagonal;
    VectorXd lambda;
    double shift = 0;
    int wait = 0, last_wait = 0; ///< iterations until the exact second derivative is tried again

    /// The exact second derivative where it is positive; where it is not, as in cloth that is pushed
    /// together, that without the pushing bars. The exact one is then tried again after ever longer waits.
    bool factorise(const Points& x) {
        if (wait == 0) {
            if (saddle.factorise(problem.stiffness, shift * diagonal, x, lambda)) {
                last_wait = 0;
                return true;
            }
            wait = last_wait = std::min(2 * last_wait + 1, longest_wait);
        }
        --wait;
        const VectorXd pulls = lambda.cwiseMax(0);
        for (;; shift = std::max(shift_growth * shift, first_shift)) {
            if (shift > most_shift) return false;
            if (saddle.factorise(problem.stiffness, shift * diagonal, x, pulls)) return true;
        }
    }

    /// Back to the lengths, by the last linearisation. False when that does not lead there.
    bool restore(Points& x) {
        VectorXd correction;
        VectorXd c = misfit(saddle.bars(), x);
        double strain = strain_of(saddle.bars(), c);
        for (int i = 0; i < most_restores && strain > options.strain; ++i) {
            saddle.restore(c, correction);
            flat(x) += correction;
            c = misfit(saddle.bars(), x);
            const double next = strain_of(saddle.bars(), c);
            if (!(next < restore_rate * strain)) return next < 1e-6 && next < strain;
            strain = next;
        }
        return strain <= options.strain;
    }

    /// Onto the lengths to begin with: near them by one linearisation, from farther off by as many as it
    /// takes.
    bool start(Points& x) {
        const Points given = x;
        if (strain_of(saddle.bars(), misfit(saddle.bars(), x)) < near_enough && factorise(x) && restore(x))
            return true;
        x = given;
        return make_isometric(saddle, problem, x, options.strain);
    }

    /// Change of energy + tension . misfit from x by `step`: the energy is quadratic, so that nothing
    /// cancels.
    double change(const VectorXd& g, const VectorXd& step, const VectorXd& tension, const VectorXd& before,
                  const Points& after) const {
        return g.dot(step) + 0.5 * step.dot(product(problem.stiffness, step)) +
               tension.dot(misfit(saddle.bars(), after) - before);
    }

    /// Goes along d and back to the lengths, as far as it lowers the energy. Returns the share gone, 0: none.
    double advance(Points& x, const VectorXd& g, const VectorXd& c, const VectorXd& d,
                   const VectorXd& tension) {
        VectorXd balance = g;
        add_tensions(saddle.bars(), x, tension, balance);
        const double slope = balance.dot(d);
        // Of the sum of tension . misfit, whose terms are rounded with the coordinates.
        const double noise =
            rounding * (tension.norm() * flat(x).cwiseAbs().maxCoeff() + g.norm() * d.norm());
        for (double t = within_turn(saddle.bars(), d, options.max_turn); t > 1e-6; t *= 0.5) {
            Points trial = x;
            flat(trial) += t * d;
            if (!restore(trial)) continue;
            double gain = -change(g, flat(trial) - flat(x), tension, c, trial);
            if (-gain > sufficient * t * slope + noise) continue;
            for (double further = 2 * t; gain > too_stiff * -slope * t * (1 - t / 2) && further < 9;
                 further *= 2) {
                Points beyond = x;
                flat(beyond) += further * d;
                if (within_turn(saddle.bars(), further * d, options.max_turn) < 1 || !restore(beyond)) break;
                const double more = -change(g, flat(beyond) - flat(x), tension, c, beyond);
                if (more <= gain) break;
                gain = more;
                trial = std::move(beyond);
            }
            x = std::move(trial);
            return t;
        }
        return 0;
    }
};

} // namespace

void add_spring(IsometricProblem& problem, const std::vector<std::pair<int, double>>& point,
                const Vec3& place, double stiffness) {
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& [i, wi] : point) {
        problem.load[i] += stiffness * wi * place;
        for (const auto& [j, wj] : point)
            entries.emplace_back(i, j, stiffness * wi * wj);
    }
    Eigen::SparseMatrix<double> spring(problem.stiffness.rows(), problem.stiffness.cols());
    spring.setFromTriplets(entries.begin(), entries.end());
    problem.stiffness += spring;
}

bool make_isometric(Saddle& saddle, const IsometricProblem& problem, Points& x, double strain) {
    const double shift = restoring_shift * problem.stiffness.diagonal().mean();
    const VectorXd none = VectorXd::Zero(3 * x.size()), slack = VectorXd::Zero(saddle.bars().size());
    VectorXd d, y;
    double best = strain_of(saddle.bars(), misfit(saddle.bars(), x));
    for (int i = 0, waited = 0; i < 100 && best > strain && waited < 8; ++i, ++waited) {
        if (!saddle.factorise(problem.stiffness, shift, x, slack)) return false;
        saddle.solve(none, misfit(saddle.bars(), x), d, y);
        flat(x) += within_turn(saddle.bars(), d, 0.3) * d;
        const double now = strain_of(saddle.bars(), misfit(saddle.bars(), x));
        if (now < 0.9 * best) waited = 0;
        best = std::min(best, now);
    }
    return strain_of(saddle.bars(), misfit(saddle.bars(), x)) <= strain;
}

IsometricResult settle_isometric(Saddle& saddle, const IsometricProblem& problem, Points& x,
                                 const IsometricOptions& options, const VectorXd& tension) {
    IsometricResult result;
    const int before = saddle.factorisations();
    Descent descent{saddle, problem, options, problem.stiffness.diagonal().mean(), tension};
    if (descent.lambda.size() != Eigen::Index(problem.bars.size()))
        descent.lambda.setZero(problem.bars.size());
    const bool isometric = descent.start(x);
    VectorXd d, y;
    for (;; ++result.iterations) {
        const VectorXd bent = product(problem.stiffness, flat(x)), g = bent - flat(problem.load);
        VectorXd balance = g;
        add_tensions(saddle.bars(), x, descent.lambda, balance);
        const VectorXd c = misfit(saddle.bars(), x);
        result.strain = strain_of(saddle.bars(), c);
        result.residual = longest(balance, problem.held);
        result.energy = flat(x).dot(0.5 * bent - flat(problem.load));
        if (!isometric) {
            result.end = IsometricEnd::not_isometric;
            break;
        }
        if (result.residual <= options.tolerance && result.strain <= options.strain) {
            result.end = IsometricEnd::settled;
            break;
        }
        if (result.iterations >= options.max_iterations) break;
        if (!descent.factorise(x)) {
            result.end = IsometricEnd::stalled;
            break;
        }
        saddle.solve(balance, c, d, y);
        const VectorXd tension_there = descent.lambda + y;
        const double t = descent.advance(x, g, c, d, tension_there);
        if (t == 0) {
            descent.shift = std::max(shift_growth * descent.shift, first_shift);
            if (descent.shift <= most_shift) continue;
            result.end = IsometricEnd::stalled;
            break;
        }
        descent.lambda += t * y;
        descent.shift = t < 0.3                       ? std::max(shift_growth * descent.shift, first_shift)
                        : descent.shift < first_shift ? 0
                                                      : shift_decay * descent.shift;
    }
    result.tension = descent.lambda;
    result.factorisations = saddle.factorisations() - before;
    return result;
}

bool is_stable(Saddle& saddle, const IsometricProblem& problem, const Points& x, const VectorXd& tension) {
    return saddle.factorise(problem.stiffness, 0, x, tension);
}

} // namespace toile
