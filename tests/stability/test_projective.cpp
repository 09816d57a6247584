// SPDX-License-Identifier: GPL-3.0-or-later
// Projective dynamics: an iteration takes away a share of about the strain.

#include "draping/stability/boundary.h"
#include "tests/stability/scenes.h"

using namespace toile;
using namespace toile::test;

TEST_CASE("stability: projective dynamics leaves 1 - strain per iteration") {
    CHECK(projective_rate(1e-3) == Approx(1 - 1e-3).epsilon(1e-5));
    const StabilityScene s = stability_scene(Method::projective, "plucked");
    // 4 %: on a mesh of a dozen edges the pluck is nearly its slowest motion, not quite on jittered ones.
    CHECK(check_boundary(s, stability_meshes(5), {1e3, 1e4}, 0.96, 1.04) == 36);
}

TEST_CASE("stability: the rate of projective dynamics is that of theory to a thousandth") {
    const StabilityScene s = stability_scene(Method::projective, "plucked");
    for (const double stiffness : {1e3, 1e4, 1e5}) {
        const StabilityColumn column = s.run({MeshKind::aligned, 0}, stiffness, {100, 300});
        const double rate = std::pow(column.outcomes[1].measure / column.outcomes[0].measure, 1.0 / 200);
        const double theory = projective_rate(10 / stiffness, 9.8696044 / stiffness);
        INFO(stiffness << ": " << rate << ", theory " << theory);
        CHECK((1 - rate) / (1 - theory) == Approx(1).epsilon(0.01));
    }
}
