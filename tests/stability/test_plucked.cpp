// SPDX-License-Identifier: GPL-3.0-or-later
// Methods that keep lengths, in the swing of a cantilever.

#include "tests/stability/scenes.h"

using namespace toile;
using namespace toile::test;

TEST_CASE("stability: cloth on edge midpoints that is held loses its swing from where BDF2 does and not before") {
    // 12 %: unstructured strips of three rows lose up to 5 % of the amplitude less.
    CHECK(check_boundary(stability_scene(Method::nonconforming, "plucked"), stability_meshes(0), {1e4}, 0.88, 1.12) == 3);
}

TEST_CASE("stability: inextensible cloth loses its swing from where implicit Euler does and not before, whatever its shear") {
    CHECK(check_boundary(stability_scene(Method::inextensible, "plucked"), stability_meshes(1), {1e2, 1e5, 1e7}, 0.94, 1.06) == 18);
}

TEST_CASE("stability: shear that is much stiffer in a step than mass does not blow inextensible cloth up") {
    // Projection to lengths knows no shear. With lines that were stiff beside mass alone it gave energy to it from 30 to 1000 of these shares.
    const StabilityScene s = stability_scene(Method::inextensible, "plucked");
    for (const double stiffness : {1e4, 1e5}) {
        const double shear = 0.5 * stiffness * 1e-3, edge = 0.1 / 12; // G, J/m2, and l
        const auto at = [&](double share) { return std::sqrt(share * 0.15 * edge * edge / shear); }; // of G h^2 / (rho l^2)
        for (const StabilityOutcome& outcome :
             s.run({MeshKind::aligned, 0}, stiffness, {at(10), at(100), at(300), at(1000), at(3000)}).outcomes) {
            INFO(stiffness << ", " << outcome.measure);
            CHECK(outcome.failure != "blew up");
        }
    }
}
