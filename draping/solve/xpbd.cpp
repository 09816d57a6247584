// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/xpbd.h"

#include <algorithm>

namespace toile {

namespace {

constexpr double tiny = 1e-12; // m, below which the direction of a zero-rest-length spring counts as none

/// What draws the vector d together, whose derivative by node k is share[k] times the identity.
template <std::size_t N>
Constraint drawn_together(const Vec3& d, const std::array<int, N>& nodes, const std::array<double, N>& share,
                          double rest, double stiffness, double cap) {
    Constraint c;
    const double length = d.norm();
    if (length < std::max(rest, tiny)) return c;
    c.count = int(N);
    c.value = length - rest;
    for (std::size_t k = 0; k < N; ++k) {
        c.nodes[k] = nodes[k];
        c.gradient[k] = share[k] * d / length;
    }
    c.stiffness = stiffness;
    c.cap = cap;
    return c;
}

constexpr double uncapped = std::numeric_limits<double>::infinity();

/// Loads other than gravity as constraints.
struct LoadConstraints {
    const Loads& loads;

    int count() const { return int(loads.stitches.size() + loads.hooks.size() + loads.elastics.size()); }
    Constraint at(int k, const Points& x) const {
        const int stitches = int(loads.stitches.size()), hooks = int(loads.hooks.size());
        if (k < stitches) {
            const StitchSpring& s = loads.stitches[k];
            const Vec3 d = x[s.a] - (1 - s.r) * x[s.b[0]] - s.r * x[s.b[1]];
            return drawn_together<3>(d, {s.a, s.b[0], s.b[1]}, {1, s.r - 1, -s.r}, 0, s.stiffness, s.cap);
        }
        if (k < stitches + hooks) {
            const HookSpring& s = loads.hooks[k - stitches];
            return drawn_together<1>((x[s.node] - s.place).cwiseProduct(s.axes), {s.node}, {1}, 0, s.stiffness, s.cap);
        }
        const ElasticSegment& s = loads.elastics[k - stitches - hooks];
        return drawn_together<2>(x[s.b] - x[s.a], {s.a, s.b}, {-1, 1}, s.rest, s.stiffness / s.rest, uncapped);
    }
};

/// Moves the nodes of one constraint toward what implicit Euler would have; `force` is what it does by then, N per gradient.
void project(const Constraint& c, const std::vector<double>& inverse_mass, double h, double& force, Points& x) {
    double mobility = 0;
    for (int k = 0; k < c.count; ++k) mobility += h * h * inverse_mass[c.nodes[k]] * c.gradient[k].squaredNorm();
    const double now =
        mobility > 0 ? std::clamp(force - (c.value + force / c.stiffness) / (mobility + 1 / c.stiffness), -c.cap, c.cap) : 0;
    for (int k = 0; k < c.count; ++k) x[c.nodes[k]] += h * h * inverse_mass[c.nodes[k]] * (now - force) * c.gradient[k];
    force = now;
}

} // namespace

XpbdStepper::XpbdStepper(std::unique_ptr<NodeProblem> problem, const ConstraintEnergy& energy, Response& response,
                         const StepOptions& options, const XpbdOptions& how)
    : ProblemStepper(std::move(problem), response, options), energy_(energy), how_(how) {}

void XpbdStepper::substep(const Moving& cloth, Points& x, Points& v, const std::vector<double>& inverse_mass, double h) {
    const Points start = x;
    const LoadConstraints loads{problem_};
    const int own = energy_.constraint_count(), all = int(last_.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (inverse_mass[i] == 0) continue;
        v[i] += h * (inverse_mass[i] * lasting(cloth, int(i)) - problem_.gravity * Vec3::UnitY());
        x[i] += h * v[i];
    }
    for (const Constrained& c : last_)
        for (int k = 0; k < c.constraint.count; ++k)
            x[c.constraint.nodes[k]] += h * h * inverse_mass[c.constraint.nodes[k]] * c.force * c.constraint.gradient[k];
    for (int sweep = 0; sweep < how_.sweeps; ++sweep)
        for (int k = 0; k < all; ++k) {
            last_[k].constraint = k < own ? energy_.constraint(k, x) : loads.at(k - own, x);
            project(last_[k].constraint, inverse_mass, h, last_[k].force, x);
        }
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = (x[i] - start[i]) / (h * (1 + options_.damping * h));
}

ResponseDone XpbdStepper::step(Moving& cloth, const Points& body_end) {
    const std::size_t n = cloth.x.size();
    const double dt = options_.time_step;
    cloth.velocity.resize(n, Vec3::Zero());
    const std::vector<double> inverse = inverse_mass();
    if (last_.empty() || !(acting_ == problem_)) { // new loads have done nothing yet
        acting_ = problem_;
        last_.resize(energy_.constraint_count());
        last_.resize(energy_.constraint_count() + LoadConstraints{problem_}.count());
    }
    Points x = cloth.x, v = cloth.velocity;
    for (int k = 0; k < how_.substeps; ++k) substep(cloth, x, v, inverse, dt / how_.substeps);
    Points mean(n);
    for (std::size_t i = 0; i < n; ++i) mean[i] = (x[i] - cloth.x[i]) / dt;
    return go(cloth, response_, inverse, body_end, options_, mean, v);
}

} // namespace toile
