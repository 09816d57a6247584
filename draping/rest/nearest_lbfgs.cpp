// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/rest/nearest.h"

#include <nlopt.hpp>

#include <cmath>
#include <exception>

namespace toile {

namespace {

struct Objective {
    const PrescribedEnergy energy;
    int evaluations = 0;

    static double call(const std::vector<double>& v, std::vector<double>& gradient, void* self) {
        Objective& o = *static_cast<Objective*>(self);
        ++o.evaluations;
        Points x(v.size() / 3);
        std::copy(v.begin(), v.end(), x.front().data());
        if (!gradient.empty()) {
            Eigen::VectorXd g = Eigen::VectorXd::Zero(Eigen::Index(v.size()));
            o.energy.add_gradient(x, g);
            std::copy(g.data(), g.data() + g.size(), gradient.begin());
        }
        return o.energy.value(x);
    }
};

} // namespace

NearestShape nearest_shape_lbfgs(const Prescribed& data, const Points& start, const NearestOptions& options) {
    NearestShape shape;
    shape.x = start;
    if (start.empty()) {
        shape.end = NearestEnd::minimum;
        return shape;
    }
    Objective objective{PrescribedEnergy(data), 0};
    nlopt::opt lbfgs(nlopt::LD_LBFGS, unsigned(3 * start.size()));
    lbfgs.set_vector_storage(5); // NLopt's own choice is many times slower per evaluation
    lbfgs.set_min_objective(Objective::call, &objective);
    lbfgs.set_maxeval(20 * options.max_iterations);
    lbfgs.set_ftol_rel(1e-15);
    lbfgs.set_xtol_rel(1e-13);
    std::vector<double> v(start.front().data(), start.front().data() + 3 * start.size());
    try {
        double best = 0;
        const nlopt::result result = lbfgs.optimize(v, best);
        shape.end = result == nlopt::MAXEVAL_REACHED ? NearestEnd::iterations : NearestEnd::minimum;
    } catch (const nlopt::roundoff_limited&) {
        shape.end = NearestEnd::minimum; // v holds the best; whether it is one the gradient says
    } catch (const std::exception&) {
        shape.end = NearestEnd::stalled;
    }
    std::copy(v.begin(), v.end(), shape.x.front().data());
    shape.energy = objective.energy.value(shape.x);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(Eigen::Index(v.size()));
    objective.energy.add_gradient(shape.x, g);
    shape.gradient = gradient_measure(data, g);
    if (!std::isfinite(shape.energy)) shape.end = NearestEnd::stalled; // NLopt takes it for success
    shape.iterations = objective.evaluations;
    return shape;
}

} // namespace toile
