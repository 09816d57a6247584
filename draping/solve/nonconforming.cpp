// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/nonconforming.h"

#include <algorithm>
#include <numeric>

namespace toile {

namespace {

constexpr double gravity = 9.81; // m/s2, by which forces are measured
constexpr double taken_up = 0.4; // of what contact does in a step: a ghost node is up to some three times as mobile as its mass says
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
    weight_ = gravity * std::accumulate(node_mass_.begin(), node_mass_.end(), 0.0);
    // One iteration a step; what it leaves of lengths, and of balance at rest, the next takes up.
    motion_options_.max_iterations = 1;
    motion_options_.tolerance = 1e-5;
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

const BlockMatrix* NonconformingStepper::load_stiffness(const Points& x) {
    if (loads_.stitches.empty() && loads_.hooks.empty() && loads_.elastics.empty()) return nullptr;
    if (stiffness_.block_rows() == 0 || loads_ != coupled_) {
        std::vector<std::pair<int, int>> pairs;
        couplings(loads_, pairs);
        stiffness_ = BlockMatrix(int(x.size()), pairs);
        coupled_ = loads_;
    }
    stiffness_.set_zero();
    add_hessian(loads_, x, stiffness_);
    return &stiffness_;
}

/// Velocities of the nodes under loads and these forces of contact (N).
Points NonconformingStepper::candidate(const Moving& cloth, const Points& contact) {
    motion_options_.time_step = options_.time_step;
    motion_options_.damping = options_.damping;
    motion_options_.drawn_in = drawn_in;
    GhostLoads acting{load_forces(cloth.x), load_stiffness(cloth.x)};
    for (std::size_t i = 0; i < contact.size(); ++i) acting.forces[i] += contact[i];
    Points v = try_step(motion_, Vec3::Zero(), acting, motion_options_).ghost_velocity;
    for (std::size_t i = 0; i < v.size(); ++i)
        if (inverse_mass_[i] == 0) v[i].setZero();
    slow(v, options_.time_step, options_.max_motion);
    return v;
}

/// Takes up part of what contact has done: impacts of a single step are no lasting force, and none bears more than all the cloth.
void NonconformingStepper::remember(const Points& done, Points& force) const {
    for (std::size_t i = 0; i < force.size(); ++i) {
        const double most = std::min(std::max(2 * force[i].norm(), gravity * node_mass_[i]), weight_);
        force[i] += taken_up * (done[i] - force[i]);
        if (const double now = force[i].norm(); now > most) force[i] *= most / now;
    }
}

ResponseDone NonconformingStepper::step(Moving& cloth, const Points& body_end) {
    const std::size_t n = cloth.x.size();
    const double dt = options_.time_step;
    cloth.velocity.resize(n, Vec3::Zero());
    cloth.other_force.resize(n, Vec3::Zero());
    cloth.touches.clear();
    start_at(cloth);
    const ResponseStep seen{dt, cloth.x, cloth.velocity, inverse_mass_, body_end};
    ResponseDone done;
    Points contact(n, Vec3::Zero()), v = cloth.velocity;
    const auto answer = [&] {
        const Points before = v;
        done = respond(cloth, response_, seen, v);
        for (std::size_t i = 0; i < n; ++i) contact[i] = node_mass_[i] / dt * (v[i] - before[i]);
    };
    if (response_.known_at_start()) {
        answer();
        cloth.other_force = contact;
        v = candidate(cloth, contact);
    } else {
        v = candidate(cloth, cloth.other_force);
        for (std::size_t i = 0; i < n; ++i) // what the response is to do anew
            v[i] -= dt * inverse_mass_[i] * cloth.other_force[i];
        answer();
        remember(contact, cloth.other_force);
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
