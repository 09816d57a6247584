// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Coulomb friction of the cloth on the body, for statics: every touching node is tied to the place where it
// came to rest, by a force that grows with its distance along the body and ends at the friction limit. Normals
// and normal forces are lagged. The tie does not creep: it has no velocity in it.
// The mollifier is that of Li et al.: Incremental Potential Contact, 2020.

#include "draping/algebra/block_matrix.h"

namespace toile {

struct Friction {
    double coefficient = 0;
    double slip = 1e-4;       ///< m, distance from its place at which a node has the whole friction force
    std::vector<Vec3> place;  ///< per node: where it came to rest
    std::vector<Vec3> normal; ///< per node, unit; lagged
    std::vector<double> force; ///< per node: lagged normal force, N; 0 where nothing touches
};

double value(const Friction& friction, const Points& x);
void add_gradient(const Friction& friction, const Points& x, Eigen::VectorXd& g);
void add_hessian(const Friction& friction, const Points& x, BlockMatrix& h);

/// Force of friction on node i at x, N.
Vec3 friction_force(const Friction& friction, const Points& x, int i);

} // namespace toile
