// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fit/optimise.h"

#include "geometry/text.h"

#include <Eigen/Cholesky>
#include <nlopt.hpp>

#include <cmath>
#include <exception>
#include <limits>
#include <stdexcept>

namespace toile {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int most_noisy = 10; ///< unknowns of cobyla

/// Unknowns as NLopt has them: the problem's are start + scale q.
struct Scale {
    Eigen::VectorXd start, low, high;
    Eigen::MatrixXd scale;

    Eigen::VectorXd at(const std::vector<double>& q) const {
        const Eigen::VectorXd v = start + scale * Eigen::Map<const Eigen::VectorXd>(q.data(), Eigen::Index(q.size()));
        return v.cwiseMax(low).cwiseMin(high); // bounds are kept but for rounding
    }
};

/// With slsqp, whose first step takes the second derivative for the identity, that is made true; others have bounds along
/// their unknowns and are given its diagonal.
Scale scale_of(const OptimiseProblem& p, Optimiser optimiser) {
    const Eigen::Index n = p.start.size();
    Scale s{p.start, p.low, p.high, Eigen::MatrixXd::Identity(n, n)};
    if (p.curvature.size() == 0) return s;
    if (optimiser == Optimiser::slsqp) {
        const Eigen::LLT<Eigen::MatrixXd> factor(p.curvature);
        if (factor.info() != Eigen::Success) throw std::invalid_argument("the curvature is not positive definite");
        s.scale = factor.matrixU().solve(s.scale);
    } else {
        s.scale = p.curvature.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
    }
    return s;
}

/// What NLopt calls, and what it must not be left to keep: errors, and the best place.
struct Search {
    const OptimiseProblem& problem;
    const OptimiseOptions& options;
    nlopt::opt& nlopt;
    Scale scale;
    OptimiseResult result;
    std::exception_ptr error;
    double far = 0; ///< a value above all that were found, for places that are not there

    double unequal_at(const Eigen::VectorXd& at, std::string* worst) const {
        double most = 0;
        for (const Equality& e : problem.equalities) {
            const double off = std::abs(e.value(at, nullptr));
            if (!(off <= most)) {
                most = off;
                if (worst) *worst = e.name;
            }
        }
        return most;
    }

    /// What is unequal by less than the tolerance is equal.
    bool better(double value, double unequal) const {
        const bool holds = unequal <= options.equal_within, held = result.unequal <= options.equal_within;
        if (holds != held) return holds;
        return holds ? value < result.value : unequal < result.unequal;
    }

    void keep(const Eigen::VectorXd& at, double value) {
        const double unequal = unequal_at(at, nullptr);
        if (result.at.size() > 0 && !better(value, unequal)) return;
        result.at = at;
        result.value = value;
        result.unequal = unequal;
    }

    double evaluate(const Differentiable& f, const std::vector<double>& q, std::vector<double>& gradient) {
        Eigen::VectorXd g = Eigen::VectorXd::Zero(Eigen::Index(q.size()));
        const double value = f(scale.at(q), gradient.empty() ? nullptr : &g);
        if (!gradient.empty() && !g.allFinite()) {
            if (std::isfinite(value)) throw std::runtime_error("a gradient is not a number");
            g.setZero();
        }
        const Eigen::VectorXd scaled = scale.scale.transpose() * g;
        std::copy(scaled.data(), scaled.data() + (gradient.empty() ? 0 : scaled.size()), gradient.begin());
        return value;
    }

    static double objective(const std::vector<double>& q, std::vector<double>& gradient, void* self) {
        Search& s = *static_cast<Search*>(self);
        try {
            ++s.result.evaluations;
            const double value = s.evaluate(s.problem.value, q, gradient);
            if (std::isnan(value)) throw std::runtime_error("the objective is not a number");
            if (value < infinity) {
                s.far = std::max(s.far, 10 * (1 + std::abs(value)));
                s.keep(s.scale.at(q), value);
            }
            if (s.problem.stop && s.problem.stop()) s.nlopt.force_stop();
            return std::min(value, std::max(s.far, 1.0));
        } catch (...) { // NLopt would lose the message
            s.error = std::current_exception();
            s.nlopt.force_stop();
            return infinity;
        }
    }

    struct Side {
        Search* search;
        const Equality* equality;
    };
    static double equality(const std::vector<double>& q, std::vector<double>& gradient, void* self) {
        const Side& side = *static_cast<Side*>(self);
        try {
            const double value = side.search->evaluate(side.equality->value, q, gradient);
            if (!std::isfinite(value)) throw std::runtime_error(side.equality->name + " is not a number");
            return value;
        } catch (...) {
            side.search->error = std::current_exception();
            side.search->nlopt.force_stop();
            return 0;
        }
    }

    /// The bounds where unknowns are mixed: low - p and p - high, none above 0.
    static void beyond_bounds(unsigned count, double* values, unsigned n, const double* q, double* gradient, void* self) {
        const Scale& s = static_cast<Search*>(self)->scale;
        const Eigen::VectorXd at = s.start + s.scale * Eigen::Map<const Eigen::VectorXd>(q, n);
        Eigen::Map<Eigen::VectorXd> v(values, count);
        v << s.low - at, at - s.high;
        if (!gradient) return;
        Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> g(gradient, count, n);
        g << -s.scale, s.scale;
    }
};

void refuse(const OptimiseProblem& p, const OptimiseOptions& o) {
    const Eigen::Index n = p.start.size();
    if (n == 0) throw std::invalid_argument("there is nothing to alter");
    if (p.low.size() != n || p.high.size() != n) throw std::invalid_argument("expected one bound for every unknown");
    for (Eigen::Index k = 0; k < n; ++k) {
        if (!(p.low[k] <= p.high[k]))
            throw std::invalid_argument(text("the bounds of unknown %d cross", int(k)));
        if (!(p.start[k] >= p.low[k] && p.start[k] <= p.high[k]))
            throw std::invalid_argument(text("unknown %d starts at %.4g, outside of its bounds %.4g and %.4g", int(k), p.start[k],
                                             p.low[k], p.high[k]));
    }
    if (Eigen::Index(p.equalities.size()) > n)
        throw std::invalid_argument(text("%d equalities for %d unknowns", int(p.equalities.size()), int(n)));
    if (o.optimiser == Optimiser::lbfgs && !p.equalities.empty())
        throw std::invalid_argument("lbfgs keeps bounds alone: equalities need slsqp or cobyla");
    if (o.optimiser == Optimiser::cobyla && n > most_noisy)
        throw std::invalid_argument(text("cobyla is for at most %d unknowns, here are %d", most_noisy, int(n)));
}

nlopt::algorithm algorithm_of(Optimiser o) {
    return o == Optimiser::slsqp ? nlopt::LD_SLSQP : o == Optimiser::lbfgs ? nlopt::LD_LBFGS : nlopt::LN_COBYLA;
}

} // namespace

const char* to_string(Optimiser o) {
    return o == Optimiser::slsqp ? "slsqp" : o == Optimiser::lbfgs ? "lbfgs" : "cobyla";
}

OptimiseResult optimise(const OptimiseProblem& problem, const OptimiseOptions& options) {
    refuse(problem, options);
    const auto list = [](const Eigen::VectorXd& v) { return std::vector<double>(v.data(), v.data() + v.size()); };
    nlopt::opt nlopt(algorithm_of(options.optimiser), unsigned(problem.start.size()));
    Search search{problem, options, nlopt, scale_of(problem, options.optimiser), {}, nullptr};
    const Scale& scale = search.scale;
    if (scale.scale.isDiagonal()) {
        const Eigen::VectorXd unit = scale.scale.diagonal();
        nlopt.set_lower_bounds(list((problem.low - problem.start).cwiseQuotient(unit)));
        nlopt.set_upper_bounds(list((problem.high - problem.start).cwiseQuotient(unit)));
    } else {
        nlopt.add_inequality_mconstraint(Search::beyond_bounds, &search, std::vector<double>(2 * problem.start.size(), 1e-12));
    }
    nlopt.set_min_objective(Search::objective, &search);
    nlopt.set_maxeval(options.max_evaluations);
    nlopt.set_ftol_rel(options.value_tolerance);
    nlopt.set_xtol_abs(options.step_tolerance);
    if (options.optimiser == Optimiser::lbfgs) nlopt.set_vector_storage(5); // NLopt's own choice is many times slower
    if (options.optimiser == Optimiser::cobyla) nlopt.set_initial_step(options.first_step);
    std::vector<Search::Side> sides;
    for (const Equality& e : problem.equalities) sides.push_back({&search, &e});
    for (Search::Side& side : sides) nlopt.add_equality_constraint(Search::equality, &side, options.equal_within);

    OptimiseResult& r = search.result;
    std::vector<double> q(problem.start.size(), 0.0);
    try {
        double least = 0;
        const nlopt::result end = nlopt.optimize(q, least);
        r.end = end == nlopt::MAXEVAL_REACHED ? OptimiseEnd::evaluations : OptimiseEnd::least;
    } catch (const nlopt::forced_stop&) {
        r.end = OptimiseEnd::stopped;
    } catch (const nlopt::roundoff_limited&) {
        r.end = OptimiseEnd::least; // no step is left that tells
    } catch (const std::exception& e) {
        r.end = OptimiseEnd::failed;
        r.why = std::string("the optimiser gave up: ") + e.what();
    }
    if (search.error) std::rethrow_exception(search.error);
    if (r.at.size() == 0) {
        r.end = OptimiseEnd::failed;
        r.why = "the objective has no value at the start";
        return r;
    }
    r.unequal = search.unequal_at(r.at, &r.worst);
    if (r.unequal > options.equal_within && r.end == OptimiseEnd::least) r.end = OptimiseEnd::unreachable;
    return r;
}

} // namespace toile
