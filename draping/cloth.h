// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Everything that acts on a garment, as one problem for a solver.

#include "draping/contact/cloth_friction.h"
#include "draping/contact/contact.h"
#include "draping/contact/untangle.h"
#include "draping/energy/sheet.h"
#include "draping/measure.h"
#include "draping/solve/node_problem.h"

#include <memory>

namespace toile {

/// The cloth of a garment as contact sees it.
ContactCloth contact_cloth(const Garment& garment);

/// The same as untangling sees it; `edge_length` (m) is the mean of its edges.
TangledCloth tangled_cloth(const Garment& garment, double edge_length);

/// kg per node.
std::vector<double> node_masses(const Garment& garment, const PanelFabrics& fabrics);

class ClothProblem final : public NodeProblem {
public:
    ClothProblem(const Garment& garment, const PanelFabrics& fabrics, const TriMesh& body,
                 const ContactOptions& contact);

    Friction friction;       ///< on the body; coefficient 0: none
    Friction cloth_friction; ///< of cloth on cloth

    Sheet& sheet() { return sheet_; }
    Contact& contact() { return contact_; }
    const Contact& contact() const { return contact_; }

    /// Every touching or later touching node is tied by friction to where it is now. If x is a state at rest,
    /// friction is at once what holds it there; otherwise it follows contact slowly.
    void rest_here(const Points& x, const FrictionCoefficients& coefficients, bool at_rest = false);

    /// Turns the strain limits on, as hard as `turn` says (see StrainLimit), and `tighter` by that share than the
    /// fabric's.
    void limit_strain(double turn, double tighter = 0);
    /// The triangles at or beyond a limit of their fabric.
    std::vector<int> beyond_limits(const Points& x) const { return beyond_strain_limits(limits_, x); }

    int blocking_pair() const { return blocking_; } ///< -1: none limited the last step asked for with shares

    /// Finds the pairs that act at x, on which gradient() and hessian() stand; what is lagged stays as it is.
    void touch(const Points& x);

    void arrive(const Points& x) override;
    double value(const Points& x) override;
    void gradient(const Points& x, Eigen::VectorXd& g) override;
    BlockMatrix& hessian(const Points& x, bool exact, bool& pattern_changed) override;
    void multiply(const Eigen::VectorXd& v, Eigen::VectorXd& product) const override;
    void curvature_along(const Points& x, const Eigen::VectorXd& g, const Eigen::VectorXd& d,
                         Eigen::VectorXd& hd) override;
    double feasible_step(const Points& x, const Eigen::VectorXd& dx, std::vector<double>* shares = nullptr) override;
    double residual(const Points& x, const Eigen::VectorXd& g) override;

private:
    double unanswered(const Points& x, int i) const override;

    void make_pattern();
    void gradient_with(const std::vector<ActivePair>& active, const Points& x, Eigen::VectorXd& g) const;
    void match_cloth_friction(const Points& x);
    void renew_friction(const Points& x);
    void adapt_friction(const Points& x);
    void take_up_friction(const Points& x);
    /// Of friction over what contact can answer, N per node.
    std::vector<double> friction_excess(const Points& x) const;

    Sheet sheet_;
    Contact contact_;
    std::vector<ActivePair> active_; ///< at the state of the last arrive()
    std::vector<PairForce> cloth_forces_; ///< then, one for each tie
    Points arrived_at_;
    BlockMatrix matrix_;
    bool matrix_made_ = false;
    std::vector<StrainLimit> limits_; ///< as the fabrics have them
    int arrivals_ = 0;               ///< since the cloth was tied to its place
    bool near_rest_ = false;
    bool trusted_ = false;           ///< the contact forces of the next arrival are those of a state at rest
    bool rising_ = false;            ///< some node's friction has yet to catch up with its normal force
    double residual_ = 0, renewed_at_ = 0;
    std::vector<double> excess_; ///< in the last residual()
    int blocking_ = -1;
};

} // namespace toile
