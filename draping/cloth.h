// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Everything that acts on a garment, as one problem for a solver.

#include "draping/contact/resting_contact.h"
#include "draping/contact/untangle.h"
#include "draping/energy/sheet.h"
#include "draping/measure.h"
#include "draping/solve/free_cloth.h"

#include <memory>

namespace toile {

/// The cloth of a garment as contact sees it.
ContactCloth contact_cloth(const Garment& garment);

/// The same as untangling sees it; `edge_length` (m) is the mean of its edges.
TangledCloth tangled_cloth(const Garment& garment, double edge_length);

/// kg per node.
std::vector<double> node_masses(const Garment& garment, const PanelFabrics& fabrics);

/// What a garment's cloth, loads and contact do, as one energy: any model of cloth with the same contact. Only the sheet of
/// equilibrium has a membrane that softens and limits that hold.
class ClothProblem final : public FreeCloth, public RestingContact {
public:
    /// The sheet of equilibrium.
    ClothProblem(const Garment& garment, const PanelFabrics& fabrics, const TriMesh& body,
                 const ContactOptions& contact);
    /// Another model, over the nodes of the garment.
    ClothProblem(std::unique_ptr<Energy> model, const Garment& garment, const PanelFabrics& fabrics, const TriMesh& body,
                 const ContactOptions& contact);

    /// A part of a sheet, with the limits that it has.
    ClothProblem(std::unique_ptr<SheetEnergy> part, std::vector<double> node_mass, ContactCloth cloth, const TriMesh& body,
                 const ContactOptions& contact);

    Sheet* sheet() { return sheet_; } ///< null: of another model
    const Sheet* sheet() const { return sheet_; }

    /// The sheet of the same mesh with another rest shape. Limits stay as hard; contact keeps the areas it began with, which only
    /// weigh its barrier.
    void rest_on(const Garment& garment, const PanelFabrics& fabrics);

    /// All points of the model (see Energy) for these nodes: its own are where the last state had them, moved along with the nodes.
    Points all_points(const Points& nodes) const;
    /// Keeps the state x, of all points, for the next all_points(); returns its nodes.
    Points keep(Points x);
    std::optional<double> kept_strain() const { return state_.empty() ? std::nullopt : energy_->kept_strain(state_); }
    int worst_node() const { return energy_->node_near(NodeProblem::worst_node()); }

    /// Turns the strain limits of a sheet on, as hard as `turn` says (see StrainLimit), and `tighter` by that share than
    /// the fabric's.
    void limit_strain(double turn, double tighter = 0);
    /// The triangles at or beyond a limit of their fabric.
    std::vector<int> beyond_limits(const Points& x) const { return beyond_strain_limits(limits_, x); }

    void arrive(const Points& x) override;
    double value(const Points& x) override;
    void gradient(const Points& x, Eigen::VectorXd& g) override { gradient_with(active(), x, g); }
    BlockMatrix& hessian(const Points& x, bool exact, bool& pattern_changed) override;
    void curvature_along(const Points& x, const Eigen::VectorXd& g, const Eigen::VectorXd& d,
                         Eigen::VectorXd& hd) override;
    double feasible_step(const Points& x, const Eigen::VectorXd& dx, std::vector<double>* shares = nullptr) override;
    double residual(const Points& x, const Eigen::VectorXd& g) override;

private:
    ClothProblem(std::unique_ptr<Energy>&& model, std::vector<double> masses, const Garment& garment, const PanelFabrics& fabrics,
                 const TriMesh& body, const ContactOptions& contact);
    int nodes() const { return contact().node_count(); }
    double unanswered(const Points&, int i) const override { return i < nodes() ? excess_[i] : 0; }
    void more_couplings(std::vector<std::pair<int, int>>& pairs) const override { contact_couplings(pairs); }
    bool add_more_hessian(const Points& x, bool exact, BlockMatrix& h) const override { return add_pair_hessian(x, exact, h); }

    void gradient_with(const std::vector<ActivePair>& active, const Points& x, Eigen::VectorXd& g);

    Sheet* sheet_ = nullptr;
    std::vector<StrainLimit> limits_; ///< as the fabrics have them
    double turn_ = 0, tighter_ = 0;   ///< as the sheet has them; turn 0: it has none
    Points state_;                    ///< of all points, the last that was kept
    std::vector<double> excess_;      ///< of friction, in the last residual()
};

} // namespace toile
