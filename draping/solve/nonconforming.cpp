// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/nonconforming.h"

#include <algorithm>
#include <numeric>

namespace toile {

namespace {

constexpr double gravity = 9.81; // m/s2, by which forces are measured
constexpr double hold_share = 10;  // of the nodes' inertia, with which touches hold
constexpr double taken_up = 0.4;   // of what cloth on cloth does in a step: a ghost node is more mobile than its mass says
constexpr double least_mass = 0.1; // of the mean, that counts as a midpoint's weight

std::vector<int> listed(const std::vector<char>& pinned) {
    std::vector<int> nodes;
    for (std::size_t i = 0; i < pinned.size(); ++i)
        if (pinned[i]) nodes.push_back(int(i));
    return nodes;
}

} // namespace

NonconformingStepper::NonconformingStepper(const Garment& garment, const std::vector<Fabric>& fabrics,
                                           std::vector<double> node_mass, const std::vector<char>& pinned, Response& response,
                                           const StepOptions& options)
    : garment_(garment), node_mass_(std::move(node_mass)), inverse_mass_(node_mass_.size(), 0.0), response_(response),
      options_(options), motion_(place_motion(make_nonconforming_cloth(garment, fabrics), garment,
                                              Points(garment.node_count, Vec3::Zero()), {{}, listed(pinned), {}})) {
    for (std::size_t i = 0; i < node_mass_.size(); ++i)
        if (!pinned[i] && node_mass_[i] > 0) inverse_mass_[i] = 1 / node_mass_[i];
    // One iteration a step; what it leaves of lengths, and of balance at rest, the next takes up.
    motion_options_.max_iterations = 1;
    motion_options_.tolerance = 1e-6;
    motion_options_.strain = 1e-8;
}

void NonconformingStepper::start_at(const Moving& cloth) {
    if (cloth.x != left_at_) replace(motion_, garment_, cloth.x, cloth.velocity);
}

Points NonconformingStepper::load_forces(const Points& x) const {
    Eigen::VectorXd g = Eigen::VectorXd::Zero(3 * Eigen::Index(x.size()));
    add_gradient(loads_, node_mass_, x, g);
    Points force(x.size());
    flat(force) = -g;
    return force;
}

void NonconformingStepper::find_load_stiffness(const Points& x) {
    if (stiffness_.block_rows() == 0 || loads_ != coupled_) {
        std::vector<std::pair<int, int>> pairs;
        for (const auto& [a, b] : garment_.edges.ends) pairs.emplace_back(a, b);
        couplings(loads_, pairs);
        stiffness_ = BlockMatrix(int(x.size()), pairs);
        coupled_ = loads_;
    }
    stiffness_.set_zero();
    add_hessian(loads_, x, stiffness_);
}

/// Velocities of the nodes under loads and what contact did in the last step; touches that pull are let go on the way.
Points NonconformingStepper::candidate(const Moving& cloth, HeldTouches& touches) {
    const std::size_t n = cloth.x.size();
    const double dt = options_.time_step;
    start_at(cloth);
    motion_options_.time_step = dt;
    motion_options_.damping = options_.damping;
    motion_options_.drawn_in = drawn_in;
    find_load_stiffness(cloth.x);
    std::vector<double> own(n);
    for (std::size_t i = 0; i < n; ++i) own[i] = (1 + options_.damping * dt) / (dt * dt) * node_mass_[i];
    touches.find_holds(own, hold_share);
    Eigen::VectorXd momentum(3 * n);
    const Points loads = load_forces(cloth.x);
    for (std::size_t i = 0; i < n; ++i) momentum.segment<3>(3 * i) = dt * (loads[i] + cloth.other_force[i]);
    touches.add(stiffness_, momentum);
    GhostLoads acting{Points(n), &stiffness_};
    flat(acting.forces) = momentum / dt;
    Points v = try_step(motion_, Vec3::Zero(), acting, motion_options_).ghost_velocity;
    for (std::size_t i = 0; i < n; ++i)
        if (inverse_mass_[i] == 0) v[i].setZero();
    touches.let_go(v, true);
    return v;
}

ResponseDone NonconformingStepper::step(Moving& cloth, const Points& body_end) {
    const Points last = cloth.other_force;
    Points v;
    const ResponseDone done = step_with_touches(cloth, response_, inverse_mass_, body_end, options_,
                                                [&](HeldTouches& touches) { return candidate(cloth, touches); }, v);
    if (!response_.known_at_start())
        for (std::size_t i = 0; i < cloth.other_force.size(); ++i) {
            const Vec3 before = last.empty() ? Vec3::Zero() : last[i];
            cloth.other_force[i] = before + taken_up * (cloth.other_force[i] - before);
        }
    finish_step(motion_, motion_options_, v);
    cloth.x = left_at_ = ghost_nodes(motion_.cloth.midpoints, motion_.x);
    cloth.velocity = ghost_nodes(motion_.cloth.midpoints, motion_.velocity);
    return done;
}

double NonconformingStepper::residual(const Moving& cloth) {
    start_at(cloth);
    Points acting = load_forces(cloth.x);
    const Points contact = cloth.contact_force();
    for (std::size_t i = 0; i < contact.size(); ++i) acting[i] += contact[i];
    const Points left = unanswered(motion_, acting);
    const std::vector<double>& mass = motion_.cloth.midpoints.mass;
    const double least = least_mass * std::accumulate(mass.begin(), mass.end(), 0.0) / double(mass.size());
    double worst = 0;
    for (std::size_t e = 0; e < left.size(); ++e) {
        const double r = left[e].norm() / (gravity * std::max(mass[e], least));
        if (!(r > worst)) continue;
        worst = r;
        worst_ = garment_.edges.ends[e][0];
    }
    return worst;
}

} // namespace toile
