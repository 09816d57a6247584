// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What every model of cloth is to a solver: an energy of the places of its nodes. A model may also lose energy when
// it moves.

#include "draping/algebra/block_matrix.h"

#include <optional>

namespace toile {

enum class HessianKind { exact, projected };

class Energy {
public:
    virtual ~Energy() = default;

    /// A model may have points of its own, numbered after the nodes of the garment. Masses of all, kg, by those of the nodes.
    virtual std::vector<double> masses(std::vector<double> of_nodes) const { return of_nodes; }
    /// Moves the nodes of `x` to `nodes` and the model's own points along with them; when x is empty they are put there anew.
    virtual void carry(Points& x, const Points& nodes) const { x = nodes; }
    /// A node beside a point of the model's own, or the node itself.
    virtual int node_near(int point) const { return point; }
    /// Largest strain of triangles that a model has in the place of those between nodes.
    virtual std::optional<double> kept_strain(const Points& x) const { return (void)x, std::nullopt; }

    virtual double value(const Points& x) const = 0; ///< J
    virtual void add_gradient(const Points& x, Eigen::VectorXd& g) const = 0;
    /// Blocks that add_hessian fills.
    virtual void couplings(std::vector<std::pair<int, int>>& pairs) const = 0;
    /// Exact, or positive semidefinite.
    virtual void add_hessian(const Points& x, HessianKind kind, BlockMatrix& h) const = 0;

    /// Called when a matrix has a new pattern, before add_hessian fills it: the place to look up where blocks lie.
    virtual void find_blocks(const BlockMatrix& h) { (void)h; }
    /// Adds to `product` what add_hessian leaves out of the exact second derivative's product with v at x, for the sake of
    /// a cheap factor. Nothing unless a model does.
    virtual void add_left_out(const Points& x, const Eigen::VectorXd& v, Eigen::VectorXd& product) const {
        (void)x, (void)v, (void)product;
    }

    /// Called at rest. A model with constraints takes up as forces what their stiffness held by being violated, and returns
    /// whether that was more than it promises: then rest is elsewhere.
    virtual bool take_up(const Points& x) { return (void)x, false; }

    /// Adds the forces of internal friction, N, of nodes that move with the velocities `v` (m/s). None unless a model has any.
    virtual void add_damping(const Points& x, const Points& v, Eigen::VectorXd& force) const {
        (void)x, (void)v, (void)force;
    }
    /// Adds minus their derivative by the velocities, positive semidefinite, times `factor`; the blocks are those of the
    /// Hessian.
    virtual void add_damping_matrix(const Points& x, double factor, BlockMatrix& h) const {
        (void)x, (void)factor, (void)h;
    }
};

} // namespace toile
