// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/resting_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace toile {

namespace {

constexpr double friction_rest = 10; // residual below which friction only gives way,
constexpr double friction_off = 1e4; // until the residual is above this again: forces of impacts are no friction

} // namespace

RestingContact::RestingContact(ContactCloth cloth, const TriMesh& body, const ContactOptions& options)
    : contact_(std::move(cloth), body, options) {}

void RestingContact::rest_here(const Points& x, const FrictionCoefficients& coefficients, bool at_rest) {
    friction = friction_at(x, coefficients.body);
    cloth_friction = {};
    cloth_friction.coefficient = coefficients.cloth;
    arrivals_ = 0;
    residual_ = renewed_at_ = std::numeric_limits<double>::infinity();
    near_rest_ = rising_ = frozen_ = false;
    trusted_ = at_rest;
}

void RestingContact::begin_as_part(const RestingContact& whole, const std::vector<int>& nodes, const Points& x) {
    std::vector<int> local(x.size(), -1);
    for (int k = 0; k < int(nodes.size()); ++k) local[nodes[k]] = k;
    const auto inside = [&local](const Tie& tie) {
        return std::all_of(tie.point.begin(), tie.point.end(), [&](int i) { return local[i] >= 0; });
    };
    friction = whole.friction;
    friction.ties.clear();
    cloth_friction = whole.cloth_friction;
    std::erase_if(cloth_friction.ties, [&](const Tie& tie) { return !inside(tie); });
    for (Tie& tie : cloth_friction.ties)
        for (int& i : tie.point) i = local[i];
    arrived_at_.clear();
    std::vector<char> out;
    for (const int i : nodes) {
        if (!whole.friction.ties.empty()) {
            friction.ties.push_back(whole.friction.ties[i]);
            friction.ties.back().point[0] = local[i];
        }
        arrived_at_.push_back(x[i]);
        if (!whole.contact().left_out().empty()) out.push_back(whole.contact().left_out()[i]);
    }
    contact_.leave_out(std::move(out));
    renew_every_ = whole.renew_every_;
    arrivals_ = whole.arrivals_;
    near_rest_ = whole.near_rest_;
    rising_ = whole.rising_;
    frozen_ = whole.frozen_;
    residual_ = whole.residual_;
    renewed_at_ = whole.renewed_at_;
}

void RestingContact::end_part(const RestingContact& part, const std::vector<int>& nodes, const Points& x) {
    const std::vector<char>& still = part.contact().cloth().still;
    std::vector<char> moved(x.size(), 0);
    for (std::size_t k = 0; k < nodes.size(); ++k) moved[nodes[k]] = !still[k];
    for (std::size_t k = 0; k < part.friction.ties.size(); ++k) {
        if (still[k]) continue;
        friction.ties[nodes[k]] = part.friction.ties[k];
        friction.ties[nodes[k]].point[0] = nodes[k];
    }
    std::erase_if(cloth_friction.ties, [&](const Tie& tie) {
        return std::any_of(tie.point.begin(), tie.point.end(), [&](int i) { return moved[i]; });
    });
    for (Tie tie : part.cloth_friction.ties) {
        for (int& i : tie.point) i = nodes[i];
        cloth_friction.ties.push_back(tie);
    }
    sort_ties(cloth_friction);
    arrived_at_ = x;
}

void RestingContact::match_cloth_friction(const Points& x) {
    cloth_forces_ = contact_.cloth_forces(active_);
    match_ties(cloth_friction, cloth_forces_, arrived_at_, x);
    arrived_at_ = x;
}

void RestingContact::renew_friction(const Points& x, const std::vector<double>& node_mass) {
    rising_ = false;
    const auto weight = [&](int i) { return 9.81 * node_mass[i]; };
    if (friction.coefficient > 0) {
        std::vector<double> least(x.size());
        for (int i = 0; i < int(x.size()); ++i) least[i] = weight(i);
        rising_ = renew(friction, x, contact_.body_forces(active_), least, trusted_);
    }
    if (cloth_friction.coefficient > 0) {
        Points force;
        std::vector<double> least;
        for (const PairForce& f : cloth_forces_) {
            force.push_back(f.force);
            double carried = 0;
            for (int k = 0; k < 4; ++k) carried += std::abs(f.weight[k]) * weight(f.point[k]);
            least.push_back(carried);
        }
        rising_ = renew(cloth_friction, x, force, least, trusted_) || rising_;
    }
}

void RestingContact::adapt_friction(const Points& x) {
    const bool at_rest = residual_ < friction_rest;
    if (friction.coefficient > 0) {
        const Points force = contact_.body_forces(active_);
        for (int i = 0; i < int(x.size()); ++i)
            if (friction.ties[i].force > 0) follow(friction, x, i, force[i].norm(), at_rest);
    }
    for (int t = 0; t < int(cloth_friction.ties.size()); ++t) {
        const double press = cloth_forces_[t].force.norm();
        if (cloth_friction.ties[t].force > 0)
            follow(cloth_friction, x, t, press, at_rest);
        else
            cloth_friction.ties[t].force = press;
    }
}

void RestingContact::touch(const Points& x) {
    contact_.prepare(x, Eigen::VectorXd::Zero(3 * Eigen::Index(x.size())));
    active_ = contact_.active(x);
}

bool RestingContact::renew_contact(const Points& x, const std::vector<double>& node_mass) {
    touch(x);
    if (frozen_ || (friction.coefficient == 0 && cloth_friction.coefficient == 0)) return false;
    const Stopwatch::Lap lap(contact_.clock());
    if (cloth_friction.coefficient > 0) match_cloth_friction(x);
    if (trusted_) {
        renew_friction(x, node_mass);
        trusted_ = false;
        return true;
    }
    // Near rest friction only gives way where it is more than contact can answer: less than that is friction
    // too, and forces that follow one another up and down would not come to rest. It grows only where a node would
    // give way for want of it.
    near_rest_ = residual_ < (near_rest_ ? friction_off : friction_rest);
    const bool renew = arrivals_ % renew_every_ == 0 || residual_ < 0.1 * renewed_at_;
    ++arrivals_;
    if (near_rest_ && !rising_) {
        adapt_friction(x);
    } else if (renew || near_rest_) {
        renewed_at_ = residual_;
        renew_friction(x, node_mass);
    }
    return false;
}

void RestingContact::take_up_forces(const Points& x, const std::vector<char>& pinned, Eigen::VectorXd& g) {
    take_up(friction, cloth_friction, x, pinned, g);
}

double RestingContact::with_contact_value(double sum, const std::vector<ActivePair>& active, const Points& x) const {
    const Stopwatch::Lap lap(contact_.clock());
    if (friction.coefficient > 0) sum += value(friction, x);
    if (cloth_friction.coefficient > 0) sum += value(cloth_friction, x);
    return sum + contact_.value(active);
}

void RestingContact::add_contact_gradient(const std::vector<ActivePair>& active, const Points& x,
                                          Eigen::VectorXd& g) const {
    const Stopwatch::Lap lap(contact_.clock());
    if (friction.coefficient > 0) add_gradient(friction, x, g);
    if (cloth_friction.coefficient > 0) add_gradient(cloth_friction, x, g);
    contact_.add_gradient(active, g);
}

void RestingContact::contact_couplings(std::vector<std::pair<int, int>>& pairs) const {
    contact_.couplings(active_, pairs);
    couplings(cloth_friction, pairs);
}

bool RestingContact::add_pair_hessian(const Points& x, bool exact, BlockMatrix& h) const {
    bool complete = contact_.add_hessian(x, active_, exact, h);
    if (cloth_friction.coefficient > 0) complete = add_hessian(cloth_friction, x, exact, h) && complete;
    return complete;
}

void RestingContact::add_body_friction_hessian(const Points& x, bool exact, BlockMatrix& h) const {
    const Stopwatch::Lap lap(contact_.clock());
    if (friction.coefficient > 0) add_hessian(friction, x, exact, h);
}

double RestingContact::longest_contact_step(const Points& x, const Eigen::VectorXd& dx, std::vector<double>* shares) {
    if (contact_.prepare(x, dx)) active_ = contact_.active(x);
    return contact_.feasible_step(x, dx, nullptr, shares ? &blocking_ : nullptr, shares);
}

std::vector<double> RestingContact::friction_excess(const Points& x) const {
    std::vector<double> excess(x.size(), 0.0);
    if (frozen_) return excess;
    if (friction.coefficient > 0) {
        const Points normal = contact_.body_forces(active_);
        for (int i = 0; i < int(x.size()); ++i) {
            const double limit = friction.coefficient * normal[i].norm();
            excess[i] = std::max(0.0, friction_force(friction, x, i).norm() - limit);
        }
    }
    for (int t = 0; t < int(cloth_friction.ties.size()); ++t) {
        const PairForce& f = cloth_forces_[t];
        const double limit = cloth_friction.coefficient * f.force.norm();
        const double over = friction_force(cloth_friction, x, t).norm() - limit;
        if (!(over > 0)) continue;
        for (int k = 0; k < 4; ++k) excess[f.point[k]] += std::abs(f.weight[k]) * over;
    }
    return excess;
}

} // namespace toile
