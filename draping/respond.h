// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A level brought to rest by motion in time, whatever the method, with a response to contact. Internal to the stages of a
// drape.

#include "draping/drape_run.h"
#include "draping/solve/stepper.h"

namespace toile {

/// The level at work in motion: its cloth without contact, and the response to what it meets. The start, `run.x`,
/// should cross nothing.
struct LevelInMotion {
    std::unique_ptr<ClothProblem> sheet; ///< of equilibrium, whose membrane softens and has limits; others have none
    std::unique_ptr<Response> response;
    std::unique_ptr<Stepper> stepper;
    Moving cloth;

    /// With the pins and the loads of the problem that it stands in for.
    LevelInMotion(const DrapeRun& run, const ClothProblem& at_rest);

    /// Steps until the cloth is at rest, to `tolerance` on the residual, or as many as `iterations` are worth are over;
    /// `run.x` is then where it is. A last pass is to be at rest to 1 mm/s, others to 20.
    RestResult rest(DrapeRun& run, double tolerance, int iterations, bool last);

    /// What touches now, from the pairs that `near` has.
    TouchFacts touch_facts(const Contact& near) const;
};

} // namespace toile
