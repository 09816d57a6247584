// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Coulomb friction for statics: what touches is tied to the place where it came to rest, by a force that grows with
// its distance along the surface. It reaches the friction limit (but for 0.2 %) at `slip`; a tie that gives way keeps
// 99.5 % of it from three times that distance on, or down to 95 % where its normal force goes up and down from one
// renewal to the next (see follow()). What slides is thus within the limit by more than the lagged normal forces are
// off, and what is at rest holds to the angle of friction. Ties do not creep: they have no velocity in them.
// The mollifier is that of Li et al.: Incremental Potential Contact, 2020.

#include "draping/algebra/block_matrix.h"

namespace toile {

/// Ties the vector between two places of cloth, or between a node and the body, to what it was.
struct Tie {
    std::array<int, 4> point{};     ///< nodes
    std::array<double, 4> weight{}; ///< the vector is the sum of weight x; shares of the force on the nodes
    Vec3 place = Vec3::Zero();      ///< m, the vector at rest
    Vec3 normal = Vec3::UnitY();    ///< unit; lagged
    double force = 0;               ///< lagged normal force, N; 0 where nothing touches
    double kept = 0.995;            ///< share of the limit that is kept by what has given way
    bool raised = false;            ///< follow() has raised the normal force last
    bool edge_edge = false;         ///< two and two nodes of edges; otherwise one and the three of a triangle, or one
};

struct FrictionCoefficients {
    double body = 0;  ///< Coulomb's, of cloth on the body
    double cloth = 0; ///< and of cloth on cloth
};

struct Friction {
    double coefficient = 0;
    double slip = 1e-4; ///< m, distance from its place at which a tie has the largest friction force
    std::vector<Tie> ties;
};

/// Friction on a body: a tie for every node, which holds it where it is; nothing touches yet.
Friction friction_at(const Points& x, double coefficient);

double value(const Friction& friction, const Points& x);
void add_gradient(const Friction& friction, const Points& x, Eigen::VectorXd& g);
/// Adds second derivatives, exact or positive semidefinite. False when the matrix lacks a block, which is left out.
bool add_hessian(const Friction& friction, const Points& x, bool exact, BlockMatrix& h);
/// Blocks that ties couple.
void couplings(const Friction& friction, std::vector<std::pair<int, int>>& pairs);

/// The vector that tie t holds, m.
Vec3 held_vector(const Tie& tie, const Points& x);

/// Force of tie t at x, N: on a node of weight 1, and by their weights on the others.
Vec3 friction_force(const Friction& friction, const Points& x, int t);

/// The largest force of a tie, N.
double hardest(const Friction& friction, const Tie& tie);

/// Moves the place of tie t such that, at x, friction is `force` (N, along the surface; at most what friction can do).
void hold_by(Friction& friction, const Points& x, int t, const Vec3& force);

/// How far what a tie holds is from its place, along the surface, m.
Vec3 slide(const Tie& tie, const Points& x);

/// What is left of a slide when the place is dragged along: no more than it takes to give way.
Vec3 dragged(const Friction& friction, const Vec3& slide);

/// Brings what is lagged up to date with the normal forces `force` (N, per tie). What has slid drags its place along, so
/// that friction opposes its next motion and does not pull it back to where it first was. Impacts of a single step must
/// not become friction: unless forces are `trusted` they follow a rise slowly, from `least` (N, per tie) on. Returns
/// whether some have yet to catch up.
bool renew(Friction& friction, const Points& x, const Points& force, const std::vector<double>& least, bool trusted);

/// Tells tie t its normal force (N): a lower one where friction is more than contact can answer, a higher one where it
/// gives way, or is about to, for want of it. Where forces are nearly `at_rest`, a tie that goes up and down keeps less
/// each time, and in the end no longer goes up while it slides, so that all comes to rest.
void follow(Friction& friction, const Points& x, int t, double force, bool at_rest);

} // namespace toile
