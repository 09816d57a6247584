// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/bend.h"
#include "draping/energy/stretch.h"

#include "tests/support/energy_checks.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

namespace {

Fabric woven() {
    Fabric f;
    f.name = "woven";
    f.stretch_warp = 2000;
    f.stretch_weft = 900;
    f.poisson = 0.3;
    f.shear = 60;
    f.compression = 0.2;
    f.bend_warp = 2e-2;
    f.bend_weft = 1e-2;
    f.bend_twist = 4e-3;
    f.bend_poisson = 0.2;
    f.limit_warp = 0.05;
    f.limit_weft = 0.06;
    f.limit_shear = 0.15;
    return f;
}

const FlatMesh& mesh() {
    static const FlatMesh m = jittered_rectangle(0.3, 0.2, 0.05, 0.3, 5);
    return m;
}

// Every energy of the cloth, one line each.
std::vector<TestedEnergy> energies(const Points& x) {
    const Garment g = garment_of(mesh(), 0.3);
    const std::vector<Fabric> f{woven()};
    std::vector<StrainLimit> limits = make_strain_limits(g, f);
    widen_strain_limits(limits, x, 0.2);
    return {
        stretch_energy("stretch", make_stretch(g, f)),
        stretch_energy("stretch with chords", make_stretch(g, f, {false})),
        strain_limit_energy("strain limit", limits),
        bend_energy("bend", make_bending(g, f)),
    };
}

} // namespace

TEST_CASE("energies: gradient and Hessian by finite differences, rigid motions, convex model", "[energies]") {
    for (const TestedState& state : tested_states(mesh()))
        for (const TestedEnergy& energy : energies(state.x))
            check_energy(energy, state);
}
