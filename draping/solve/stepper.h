// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A cloth in motion, step by step. How its velocities come about without contact is a method's own; what it meets is left
// to a response.

#include "draping/contact/response.h"
#include "draping/energy/loads.h"

#include <functional>
#include <optional>
#include <string>

namespace toile {

struct StepOptions {
    double time_step = 2e-3; ///< s
    double damping = 0;      ///< 1/s: share of the momentum that air takes per second
    double max_motion = 0.01; ///< m, no point moves farther in one step; faster ones are slowed
};

/// A touch that lasts from step to step.
struct HeldTouch {
    Touch touch;
    bool slides = false;
    bool began = false; ///< to slide, in the last step
};

/// A cloth on its way, and what contact did to it in the last step. Starts with `x` alone.
struct Moving {
    Points x;
    Points velocity = {};                ///< m/s; empty: at rest
    std::vector<HeldTouch> touches = {}; ///< sorted
    Points other_force = {};             ///< N per node, of all other contact
    Stopwatch contact = {};              ///< has the wall time of the response

    /// Force of contact on every node in the last step, N.
    Points contact_force() const;
};

/// m/s, of the body's points in a step that ends with them at `body_end`; they are where the response has them.
Points body_velocities(const Response& response, const Points& body_end, double dt);
/// Rate of the vector between the places that touch, by the velocities of the nodes and of the body's points.
Vec3 rate(const Touch& touch, const Points& v, const Points& body_velocity);

class Stepper {
public:
    virtual ~Stepper() = default;

    /// One step, at whose end the points of the body are at `body_end`. Throws std::runtime_error when the motion is no
    /// longer finite or has blown up.
    virtual ResponseDone step(Moving& cloth, const Points& body_end) = 0;

    /// Largest force on a node that neither contact nor what the method itself holds answered in the last step, as
    /// NodeProblem::residual() measures it.
    virtual double residual(const Moving& cloth) = 0;
    /// Where that was.
    virtual int worst_node() const = 0;

    virtual Loads& loads() = 0;
    virtual const std::vector<double>& node_mass() const = 0; ///< kg
    virtual StepOptions& options() = 0;
    virtual int factorisations() const { return 0; } ///< so far
    /// Largest strain of triangles that the method has in the place of those between nodes.
    virtual std::optional<double> kept_strain() const { return {}; }
};

double kinetic_energy(const std::vector<double>& node_mass, const Moving& cloth); ///< J

/// Slows what would go farther than `max_motion` (m) within dt. Throws std::runtime_error when a velocity is not finite.
void slow(Points& v, double dt, double max_motion);

/// What the response does, on the cloth's watch.
ResponseDone respond(Moving& cloth, Response& response, const ResponseStep& step, Points& v);

/// The end of a step whose velocities without contact are `v`: slowed, corrected by the response, and gone. What
/// contact did is then with the cloth. A method whose velocity at the end of the step is not the one that brought it there
/// gives it as `end`, which is then slowed and corrected by the same. What a response that lasts did in the last step is in
/// both, and is taken back before it acts anew. `inverse_mass`: 1/kg, 0 for what is pinned.
ResponseDone go(Moving& cloth, Response& response, const std::vector<double>& inverse_mass, const Points& body_end,
                const StepOptions& options, Points v, Points end);
inline ResponseDone go(Moving& cloth, Response& response, const std::vector<double>& inverse_mass, const Points& body_end,
                       const StepOptions& options, const Points& v) {
    return go(cloth, response, inverse_mass, body_end, options, v, v);
}

struct RestOptions {
    double tolerance = 1e-3; ///< residual at rest
    double speed = 1e-3;     ///< m/s, mean square root, at rest
    int max_steps = 5000;
    /// Called after every step; false stops.
    std::function<bool(int step, double residual)> progress;
};

struct RestResult {
    bool rested = false;  ///< both the forces and the speed are below what was asked for
    bool stopped = false; ///< by the caller
    double residual = 0;
    double speed = 0;   ///< m/s by which the last step moved the cloth, root of the mean square over the mass
    int steps = 0;
    int factorisations = 0;
    int unresolved = 0; ///< steps in which a pair touched
    std::string broken; ///< why there was no next step: the cloth is where it was before it. Empty: there was
};

/// Steps with the body at rest at `body` until the cloth is.
RestResult come_to_rest(Stepper& stepper, Moving& cloth, const Points& body, const RestOptions& options);

} // namespace toile
