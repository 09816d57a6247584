// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/energy/energy.h"
#include "draping/solve/node_problem.h"

#include <memory>

namespace toile {

/// Any model of cloth, with loads and pins and without contact of its own, as a problem for a stepper or for settle().
class FreeCloth : public NodeProblem {
public:
    /// `projected`: whether hessian() gives a positive semidefinite stand-in when it is not asked for the exact one.
    FreeCloth(std::unique_ptr<Energy> energy, std::vector<double> node_mass, bool projected = true);

    const Energy& energy() const { return *energy_; }
    bool take_up(const Points& x) { return energy_->take_up(x); } ///< see Energy

    void arrive(const Points&) override {}
    double value(const Points& x) override;
    void gradient(const Points& x, Eigen::VectorXd& g) override;
    BlockMatrix& hessian(const Points& x, bool exact, bool& pattern_changed) override;
    void multiply(const Eigen::VectorXd& v, Eigen::VectorXd& product) const override;
    void curvature_along(const Points& x, const Eigen::VectorXd& g, const Eigen::VectorXd& d,
                         Eigen::VectorXd& hd) override;
    double feasible_step(const Points&, const Eigen::VectorXd&, std::vector<double>* shares = nullptr) override;
    void damping(const Points& x, const Points& v, Eigen::VectorXd& force) override;
    void add_damping_matrix(const Points& x, double factor, BlockMatrix& h) override;
    void add_left_out(const Eigen::VectorXd& v, Eigen::VectorXd& product) const override { energy_->add_left_out(matrix_at_, v, product); }

protected:
    /// What one who adds to the energy couples, and the blocks of its second derivative; false when the matrix lacks one.
    virtual void more_couplings(std::vector<std::pair<int, int>>& pairs) const { (void)pairs; }
    virtual bool add_more_hessian(const Points& x, bool exact, BlockMatrix& h) const { return (void)x, (void)exact, (void)h, true; }

    /// The energy has become another over the same nodes.
    void renew_energy();

    std::unique_ptr<Energy> energy_;

private:
    void make_pattern();

    bool projected_;
    std::vector<std::pair<int, int>> cloth_couplings_; ///< of the energy, each once
    BlockMatrix matrix_;
    bool matrix_made_ = false;
    Points matrix_at_; ///< where the matrix was last filled
};

} // namespace toile
