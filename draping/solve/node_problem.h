// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/energy/loads.h"
#include "draping/solve/problem.h"

namespace toile {

/// A problem over nodes that have weight, and loads on them: what models of cloth have in common.
class NodeProblem : public Problem, public Loads {
public:
    explicit NodeProblem(std::vector<double> node_mass); ///< kg

    void pin(int node) { pinned_[node] = 1; }
    const std::vector<double>& node_mass() const { return node_mass_; }
    /// The node at which the last residual() was found.
    int worst_node() const { return worst_; }

    int points() const override { return int(node_mass_.size()); }
    const Eigen::VectorXd& mass() const override { return mass_; }
    const std::vector<char>& pinned() const override { return pinned_; }
    /// Forces of internal friction, N, at the velocities `v` (m/s); none unless a model has any.
    virtual void damping(const Points& x, const Points& v, Eigen::VectorXd& force) {
        (void)v;
        force.setZero(3 * Eigen::Index(x.size()));
    }
    /// Adds minus their derivative by the velocities, times `factor`, to the matrix of hessian().
    virtual void add_damping_matrix(const Points& x, double factor, BlockMatrix& h) { (void)x, (void)factor, (void)h; }
    /// Adds to `product` what the matrix of hessian() leaves out of the second derivative's product with v, for the sake of a cheap
    /// factor.
    virtual void add_left_out(const Eigen::VectorXd& v, Eigen::VectorXd& product) const { (void)v, (void)product; }

    /// Largest force on a node that is not pinned, over its weight or a tenth of the mean weight, whichever is more.
    double residual(const Points& x, const Eigen::VectorXd& g) override;

protected:
    void set_node_mass(std::vector<double> node_mass); ///< kg

    /// Force at node i beyond what g says that nothing answers, N.
    virtual double unanswered(const Points& x, int i) const {
        (void)x, (void)i;
        return 0;
    }
    void clear_pinned(Eigen::VectorXd& g) const;

    std::vector<double> node_mass_;
    std::vector<char> pinned_;

private:
    Eigen::VectorXd mass_;
    double least_mass_ = 0; ///< kg, that counts as a node's weight
    int worst_ = 0;
};

} // namespace toile
