// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/nonconforming/ghost_impulses.h"

namespace toile {

namespace {

constexpr double immovable = 1e-10; // share of the mean mobility below which a ghost node cannot be moved
constexpr int refinements = 3;

using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 3>;

} // namespace

GhostImpulses::GhostImpulses(const Midpoints& midpoints, const std::vector<char>& held)
    : ghost_(midpoints.ghost), mobility_(midpoints.count()) {
    for (int e = 0; e < midpoints.count(); ++e) mobility_[e] = held[e] ? 0 : 1 / midpoints.mass[e];
    of_ghosts_ = ghost_ * mobility_.asDiagonal() * ghost_.transpose();
    factor_.setShift(immovable * of_ghosts_.diagonal().mean());
    factor_.compute(of_ghosts_);
}

Points GhostImpulses::velocities(const Points& change) const {
    Coordinates wanted(change.size(), 3);
    for (std::size_t i = 0; i < change.size(); ++i) wanted.row(i) = change[i];
    Coordinates impulse = Coordinates::Zero(change.size(), 3);
    for (int k = 0; k < refinements; ++k) {
        const Coordinates left = wanted - of_ghosts_ * impulse;
        impulse += factor_.solve(left);
    }
    const Coordinates velocity = mobility_.asDiagonal() * (ghost_.transpose() * impulse);
    Points result(mobility_.size());
    for (std::size_t e = 0; e < result.size(); ++e) result[e] = velocity.row(e);
    return result;
}

} // namespace toile
