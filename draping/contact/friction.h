// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Coulomb friction of the cloth on the body, for statics: every touching node is tied to the place where it
// came to rest, by a force that grows with its distance along the body. It reaches the friction limit (but for
// 0.2 %) at `slip`; a node that gives way keeps 99.5 % of it from three times that distance on, or down to 95 %
// where its normal force goes up and down from one renewal to the next (see follow()). What slides is thus within
// the limit by more than the lagged normal forces are off, and what is at rest holds to the angle of friction. The
// tie does not creep: it has no velocity in it.
// The mollifier is that of Li et al.: Incremental Potential Contact, 2020.

#include "draping/algebra/block_matrix.h"

namespace toile {

struct Friction {
    double coefficient = 0;
    double slip = 1e-4;       ///< m, distance from its place at which a node has the largest friction force
    std::vector<Vec3> place;  ///< per node: where it came to rest
    std::vector<Vec3> normal; ///< per node, unit; lagged
    std::vector<double> force; ///< per node: lagged normal force, N; 0 where nothing touches
    std::vector<double> kept;  ///< per node: share of the limit that it keeps where it has given way
    std::vector<char> raised;  ///< per node: follow() has raised its normal force last
};

/// Every node tied to where it is; nothing touches yet.
Friction friction_at(const Points& x, double coefficient);

double value(const Friction& friction, const Points& x);
void add_gradient(const Friction& friction, const Points& x, Eigen::VectorXd& g);
/// Exact, or positive semidefinite.
void add_hessian(const Friction& friction, const Points& x, bool exact, BlockMatrix& h);

/// Force of friction on node i at x, N.
Vec3 friction_force(const Friction& friction, const Points& x, int i);

/// By how much, as a share, the lagged normal force of node i may be off before friction has to be told: little
/// for a node about to give way, more for one that slides or hardly needs friction.
double friction_slack(const Friction& friction, const Points& x, int i);

/// Moves the place of node i such that, at x, friction is `force` (N, along the body; at most what friction can do).
void hold_by(Friction& friction, const Points& x, int i, const Vec3& force);

/// Nodes that have slid drag their places along, so that friction opposes their next motion and does not pull them
/// back to where they first were.
void drag_places(Friction& friction, const Points& x);

/// Tells node i its normal force (N): a lower one where friction is more than contact can answer, a higher one where
/// the node slides, or is about to, for want of it. Where forces are nearly `at_rest`, a node that goes up and down
/// keeps less each time, and in the end no longer goes up while it slides, so that all comes to rest.
void follow(Friction& friction, const Points& x, int i, double force, bool at_rest);

} // namespace toile
