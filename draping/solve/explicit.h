// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Symplectic Euler in substeps (v' = v + h M^-1 f(x, v), x' = x + h v'; Provot 1995, Bridson 2002). The mean velocity of the
// substeps of a step is what its response corrects. What touched the body in the last step is held in the substeps by
// impulses that only push, with friction, so that cloth can lie still between two responses.

#include "draping/solve/problem_stepper.h"
#include "draping/solve/stability.h"

namespace toile {

class ExplicitStepper : public ProblemStepper {
public:
    using ProblemStepper::ProblemStepper;

    /// s; 0: as long as is stable where the step begins and where it ends, by Fastest::step() with a margin. A longer one blows
    /// up, which ends step() with std::runtime_error.
    double substep = 0;

    ResponseDone step(Moving& cloth, const Points& body_end) override;

    int substeps() const { return count_; }    ///< in the last step
    double stable_substep(const Points& x);    ///< s, what is taken at x unless one is given

protected:
    /// After a substep of h seconds: the place for constraints. `v` is to stay what moved the cloth.
    virtual void constrain(Points& x, Points& v, double h) { (void)x, (void)v, (void)h; }
    virtual void begin_step(const Points& x) { (void)x; }

private:
    struct Motion {
        Points x, v, impulse; ///< m and m/s per node, N s per touch
    };
    void go_on(const Moving& cloth, const Points& body_velocity, Motion& m);
    void hold_touches(const Moving& cloth, Points& v, const Points& body_velocity, Points& impulse) const;

    double stable_ = 0; ///< s, substep that is stable where the last step ended; 0: unknown
    FastestMotions fastest_;
    int count_ = 0;
};

} // namespace toile
