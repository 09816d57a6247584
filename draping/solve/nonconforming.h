// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth on edge midpoints, every triangle of which keeps its shape (draping/nonconforming), as a stepper: loads, pins and contact act
// on its ghost nodes, which are the nodes of the garment. The forces of contact of the last step stand in the solve, as with implicit
// steps, so that at rest contact has nothing left to correct and the lengths stay exact.

#include "draping/nonconforming/motion.h"
#include "draping/solve/held_touches.h"

namespace toile {

class NonconformingStepper final : public Stepper {
public:
    /// `fabrics` has one entry per panel; `node_mass` (kg) a third of every triangle at the node. Keeps references to garment and
    /// response. Throws std::invalid_argument for a fabric without weight or bending and for a triangle without area.
    NonconformingStepper(const Garment& garment, const std::vector<Fabric>& fabrics, std::vector<double> node_mass,
                         const std::vector<char>& pinned, Response& response, const StepOptions& options);

    /// Strain by which the lengths of a cloth that starts with wrong ones may change in a step, in (0, 1).
    double drawn_in = 1e-3;

    ResponseDone step(Moving& cloth, const Points& body_end) override;
    /// Of midpoints: what lies on nodes is a mean of theirs.
    double residual(const Moving& cloth) override;
    int worst_node() const override { return worst_; }
    std::optional<double> kept_strain() const override { return largest_triangle_strain(garment_, motion_.x); }
    Loads& loads() override { return loads_; }
    const std::vector<double>& node_mass() const override { return node_mass_; }
    StepOptions& options() override { return options_; }
    int factorisations() const override { return motion_.solver->factorisations(); }

    const Motion& motion() const { return motion_; }

private:
    void start_at(const Moving& cloth);
    Points load_forces(const Points& x) const;
    void find_load_stiffness(const Points& x);
    Points candidate(const Moving& cloth, HeldTouches& touches);

    const Garment& garment_;
    std::vector<double> node_mass_, inverse_mass_; ///< 1/kg, 0 for what is pinned
    Response& response_;
    StepOptions options_;
    MotionOptions motion_options_;
    Motion motion_;
    Points left_at_; ///< nodes after the last step
    Loads loads_, coupled_;
    BlockMatrix stiffness_; ///< over nodes, with the pattern of `coupled_` and of triangles
    int worst_ = 0;
};

} // namespace toile
