// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Springs that move without meeting anything.

#include "draping/energy/spring_grid.h"
#include "draping/solve/free_cloth.h"

namespace toile::test {

/// A response that has nothing to do.
struct NoContact final : Response {
    Points none;
    ResponseOptions how;

    ResponseDone respond(const ResponseStep&, Points& v) override {
        ResponseDone done;
        done.other_force.assign(v.size(), Vec3::Zero());
        return done;
    }
    Guarantee guarantee() const override { return Guarantee::none; }
    const Points& body() const override { return none; }
    const ResponseOptions& options() const override { return how; }
};

/// Springs with masses, and the stepper that moves them.
template <class S>
struct FreeSprings {
    FreeCloth problem;
    NoContact response;
    S stepper;
    Moving cloth;

    /// Not slowed, whatever goes on; with the exact second derivative.
    FreeSprings(const std::vector<Spring>& springs, const std::vector<double>& mass, const Points& x, double dt)
        : problem(std::make_unique<Springs>(springs), mass, false), stepper(problem, response, {dt, 0, 1e9}) {
        cloth.x = x;
        cloth.velocity.assign(x.size(), Vec3::Zero());
    }
    FreeSprings(const FreeSprings&) = delete; // the stepper refers to the rest

    void step() { stepper.step(cloth, {}); }
    double energy() { return problem.value(cloth.x) + kinetic_energy(problem.node_mass(), cloth); }
};

} // namespace toile::test
