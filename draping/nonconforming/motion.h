// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth in motion that keeps its lengths exactly: BDF2 as English and Bridson 2008 use it (second order, no
// force too stiff for it, little damping), the first step and the one after a contact by implicit Euler: an
// impulse breaks the course that BDF2 goes on with. Every step is one least of inertia and energy among
// isometric states. What contact does with the ghost nodes in between is told to finish_step().

#include "draping/nonconforming/cloth.h"
#include "draping/nonconforming/ghost_impulses.h"
#include "draping/nonconforming/step_solver.h"

#include <memory>

namespace toile {

struct MotionOptions {
    double time_step = 2e-3; ///< s; a step that differs from the last is one of implicit Euler
    double damping = 0;      ///< 1/s: share of the momentum that air takes per second
    double tolerance = 1e-7; ///< share of the mean midpoint's weight (9.81 m/s^2) that may go without answer
    double strain = 1e-9;    ///< of any bar, beyond what is drawn in later
    int max_iterations = 50;
    double drawn_in = 1;     ///< strain by which a wrong length may change in a step; less where contact undoes it, down to 1e-5
};

/// What holds a motion.
struct MotionHolds {
    std::vector<char> midpoints;      ///< that stay; empty: none
    std::vector<int> nodes;           ///< ghost nodes that stay, independent of each other
    std::vector<GhostSpring> springs; ///< that pull throughout
};

/// What acts on ghost nodes in a step.
struct GhostLoads {
    Points forces = {};                     ///< N per node at the start of the step; empty: none
    const BlockMatrix* stiffness = nullptr; ///< N/m, by which they grow against the nodes' way; positive semidefinite
};

struct Motion {
    NonconformingCloth cloth;
    IsometricProblem problem; ///< without inertia, at rest without forces
    std::unique_ptr<StepSolver> solver;
    std::unique_ptr<GhostImpulses> impulses;
    Points x, velocity;               ///< of midpoints
    Points x_before, velocity_before; ///< a step earlier; empty when there is none
    double last_step = 0;             ///< s
    Eigen::VectorXd tension;          ///< N per bar, then three per node held
    std::vector<double> drawn_in;     ///< strain, per bar, by which it may change in the next step; empty at the start
    bool isometric = false;           ///< the start could be made to keep the lengths
    Points candidate, candidate_velocity;
};

struct MotionStep {
    IsometricEnd end = IsometricEnd::iterations; ///< settled, or out of iterations
    int iterations = 0, factorisations = 0;
    Points ghost_velocity; ///< m/s per node: the way of this step over its duration
};

/// Below, positions, velocities or forces that are not one per node throw std::invalid_argument.

/// At rest where `nodes` are (positions of ghost nodes), whatever the lengths there.
Motion place_motion(NonconformingCloth cloth, const Garment& garment, const Points& nodes,
                    const MotionHolds& holds = {});

/// At rest at the isometric state nearest to `nodes`.
Motion start_motion(NonconformingCloth cloth, const Garment& garment, const Points& nodes,
                    const MotionHolds& holds = {});

/// Where the cloth would go in a step under gravity (m/s^2) and what acts on ghost nodes. May be asked for
/// several times; the motion goes on by finish_step(). Throws std::runtime_error when numbers are not finite.
MotionStep try_step(Motion& motion, const Vec3& gravity, const GhostLoads& loads, const MotionOptions& options);

/// Goes on to the state of the last try_step().
void finish_step(Motion& motion, const MotionOptions& options);

/// Goes on with ghost velocities that contact has corrected. The impulses on ghost nodes that make the
/// difference are looked for and act on midpoints through the transpose of the ghost map, so that ghost nodes
/// end where contact has put them, and midpoints gain the momentum that nodes of a third of the triangles' mass
/// do. That state keeps the lengths but for the correction, which the next step makes good.
void finish_step(Motion& motion, const MotionOptions& options, const Points& ghost_velocity);

/// Force on every midpoint that nothing answers, N: bending, springs, tensions of the last step and forces on ghost nodes (N),
/// gravity with them.
Points unanswered(Motion& motion, const Points& ghost_forces);

/// Goes on from ghost nodes and their velocities, whatever the lengths there.
void replace(Motion& motion, const Garment& garment, const Points& nodes, const Points& velocity);

double kinetic_energy(const Motion& motion); ///< J
Vec3 momentum(const Motion& motion);         ///< kg m/s

} // namespace toile
