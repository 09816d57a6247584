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

/// Moves the nodes of one constraint toward what implicit Euler would have; `multiplier` is that of the substep so far.
void project(const Constraint& c, const std::vector<double>& inverse_mass, double h, double& multiplier, Points& x) {
    double mobility = 0;
    for (int k = 0; k < c.count; ++k) mobility += inverse_mass[c.nodes[k]] * c.gradient[k].squaredNorm();
    if (!(mobility > 0)) return;
    const double compliance = 1 / (c.stiffness * h * h);
    const double most = c.cap * h * h;
    const double now = std::clamp(multiplier - (c.value + compliance * multiplier) / (mobility + compliance), -most, most);
    for (int k = 0; k < c.count; ++k) x[c.nodes[k]] += inverse_mass[c.nodes[k]] * (now - multiplier) * c.gradient[k];
    multiplier = now;
}

} // namespace

XpbdStepper::XpbdStepper(std::unique_ptr<NodeProblem> problem, const ConstraintEnergy& energy, Response& response,
                         const StepOptions& options, const XpbdOptions& how)
    : ProblemStepper(std::move(problem), response, options), energy_(energy), how_(how) {}

void XpbdStepper::substep(Points& x, Points& v, const std::vector<double>& inverse_mass, double h) const {
    const Points start = x;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (inverse_mass[i] == 0) continue;
        v[i].y() -= h * problem_.gravity;
        x[i] += h * v[i];
    }
    const LoadConstraints loads{problem_};
    const int own = energy_.constraint_count(), all = own + loads.count();
    std::vector<double> multipliers(all, 0.0);
    for (int sweep = 0; sweep < how_.sweeps; ++sweep)
        for (int k = 0; k < all; ++k)
            project(k < own ? energy_.constraint(k, x) : loads.at(k - own, x), inverse_mass, h, multipliers[k], x);
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = (x[i] - start[i]) / (h * (1 + options_.damping * h));
}

ResponseDone XpbdStepper::step(Moving& cloth, const Points& body_end) {
    const std::size_t n = cloth.x.size();
    const double dt = options_.time_step;
    cloth.velocity.resize(n, Vec3::Zero());
    const std::vector<double> inverse = inverse_mass();
    Points x = cloth.x, v = cloth.velocity;
    for (int k = 0; k < how_.substeps; ++k) substep(x, v, inverse, dt / how_.substeps);
    Points mean(n);
    for (std::size_t i = 0; i < n; ++i) mean[i] = (x[i] - cloth.x[i]) / dt;
    return go(cloth, response_, inverse, body_end, options_, mean, v);
}

} // namespace toile
