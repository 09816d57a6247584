// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth in motion that keeps its lengths exactly: BDF2 as English and Bridson 2008 use it (second order, no
// force too stiff for it, little damping), the first step by implicit Euler. Every step is one least of
// inertia and energy among isometric states. What contact does with the ghost nodes in between is told to
// finish_step().

#include "draping/nonconforming/cloth.h"

#include <memory>

namespace toile {

struct MotionOptions {
    double time_step = 2e-3; ///< s; a step that differs from the last is one of implicit Euler
    double damping = 0;      ///< 1/s: share of the momentum that air takes per second
    double tolerance = 1e-7; ///< share of the mean midpoint's weight (9.81 m/s^2) that may go without answer
    double strain = 1e-9;    ///< of any bar
    int max_iterations = 50;
};

struct Motion {
    NonconformingCloth cloth;
    IsometricProblem problem; ///< without inertia, at the last forces
    std::unique_ptr<Saddle> saddle;
    Points x, velocity;               ///< of midpoints
    Points x_before, velocity_before; ///< a step earlier; empty when there is none
    double last_step = 0;             ///< s
    Eigen::VectorXd tension;          ///< N per bar
    bool isometric = false;           ///< the start could be made to keep the lengths
    Points candidate, candidate_velocity;
};

struct MotionStep {
    IsometricEnd end = IsometricEnd::iterations;
    int iterations = 0, factorisations = 0;
    Points ghost_velocity; ///< m/s per node: the way of this step over its duration
};

/// Below, positions, velocities or forces that are not one per node throw std::invalid_argument.

/// At rest at the isometric state nearest to `nodes` (positions of ghost nodes). Midpoints that are `held`
/// (empty: none) stay; springs pull throughout.
Motion start_motion(NonconformingCloth cloth, const Garment& garment, const Points& nodes,
                    const std::vector<char>& held = {}, const std::vector<GhostSpring>& springs = {});

/// Where the cloth would go in a step under gravity (m/s^2) and forces on ghost nodes (N; empty: none). May
/// be asked for several times; the motion goes on by finish_step().
MotionStep try_step(Motion& motion, const Vec3& gravity, const Points& ghost_forces,
                    const MotionOptions& options);

/// Goes on to the state of the last try_step().
void finish_step(Motion& motion, const MotionOptions& options);

/// Goes on with ghost velocities that contact has corrected. The impulses on ghost nodes that make the
/// difference are looked for and act on midpoints through the transpose of the ghost map, so that ghost nodes
/// end where contact has put them. That state keeps the lengths but for the correction, which the next step
/// makes good.
void finish_step(Motion& motion, const MotionOptions& options, const Points& ghost_velocity);

double kinetic_energy(const Motion& motion); ///< J
Vec3 momentum(const Motion& motion);         ///< kg m/s

} // namespace toile
