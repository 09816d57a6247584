// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What touches the body from step to step, in the solve of an implicit step: with the forces of the last step, and held by the
// method of multipliers (Hestenes 1969), so that what leans on the body is at rest when its forces are in balance, however stiff
// it is and however long the step.

#include "draping/algebra/block_matrix.h"
#include "draping/solve/stepper.h"

#include <functional>

namespace toile {

class HeldTouches {
public:
    /// For one step of `cloth`, whose touches it keeps up to date. `inverse_mass`: 1/kg per node, 0 for what is pinned.
    HeldTouches(Moving& cloth, const Response& response, const std::vector<double>& inverse_mass, const Points& body_end,
                double time_step);

    /// How much every touch holds, by what its nodes resist a motion in the solve with themselves: `stiffness`, N/m per node,
    /// inertia with it. A touch holds `share` times as much.
    void find_holds(const std::vector<double>& stiffness, double share);

    /// Adds what holds to the stiffness (N/m) and to the momentum (N s, three per node) of the solve. Nodes of one edge or triangle
    /// of cloth have to be coupled.
    void add(BlockMatrix& a, Eigen::VectorXd& momentum) const;

    /// Lets go what would pull at these velocities, and lets slide what friction does not hold; returns whether something changed
    /// and the velocities have to be found anew. If not, or when this is the last time, the forces are brought up to date.
    bool let_go(const Points& v, bool last);

    /// Adds what the response did to what held the cloth already. A touch lasts while its pair is near, a weld until it pulls.
    void take_up(const ResponseDone& done, const Points& v);

private:
    /// What a touch resists the rate of its places with in the solve, kg: along the normal and along the face.
    struct Hold {
        double normal = 0, along = 0;
        Mat3 matrix(const Vec3& n) const;
    };

    bool is_node(int point) const { return point < int(inverse_mass_.size()); }

    Moving& cloth_;
    const std::vector<double>& inverse_mass_;
    Points body_velocity_;
    double dt_, friction_;
    bool known_at_start_;
    std::vector<Hold> hold_; ///< of each touch
};

/// One step of `cloth`: `solve` returns the velocities of the nodes with what touched held, and the response corrects them, or
/// acts before when its forces are known at the start. What the nodes have left to go is for the caller to do: `v` receives their
/// velocities. `inverse_mass` as above; `options.damping` is not looked at.
ResponseDone step_with_touches(Moving& cloth, Response& response, const std::vector<double>& inverse_mass, const Points& body_end,
                               const StepOptions& options, const std::function<Points(HeldTouches&)>& solve, Points& v);

} // namespace toile
