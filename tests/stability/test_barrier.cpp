// SPDX-License-Identifier: GPL-3.0-or-later
// A barrier that acts farther than parts of flat cloth are apart presses it apart.

#include "tests/stability/scenes.h"

using namespace toile;
using namespace toile::test;

TEST_CASE("stability: flat cloth presses on itself from where its barrier reaches what no edge joins and not before") {
    const StabilityScene s = stability_scene(Method::equilibrium, "flat, with a barrier");
    // Soft cloth is strained by 1e-4 as soon as anything presses; what is just within reach presses little, with the square of the depth.
    CHECK(check_boundary(s, stability_meshes(2), {1e3}, 0.999, 1.1) == 9);
    // On squares halved alike the nearest such places are the ends of the other diagonal.
    CHECK(s.run({MeshKind::aligned, 0}, 1e3, {}).boundary == Approx(std::sqrt(2.0)).epsilon(1e-9));
}
