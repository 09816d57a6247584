// SPDX-License-Identifier: GPL-3.0-or-later
// Methods that keep lengths, in the swing of a cantilever.

#include "tests/stability/scenes.h"

using namespace toile;
using namespace toile::test;

TEST_CASE("stability: cloth on edge midpoints that is held loses its swing from where BDF2 does and not before") {
    // 12 %: unstructured strips of three rows lose up to 5 % of the amplitude less.
    CHECK(check_boundary(stability_scene(Method::nonconforming, "plucked"), stability_meshes(0), {1e4}, 0.88, 1.12) == 3);
}

TEST_CASE("stability: inextensible cloth loses its swing from where implicit Euler does and not before") {
    CHECK(check_boundary(stability_scene(Method::inextensible, "plucked"), stability_meshes(1), {1e2}, 0.94, 1.06) == 6);
}

TEST_CASE("stability: inextensible cloth blows up where its shear is about as stiff in a step as its lines") {
    // No theory has this boundary. Lines are 500 m / h^2 stiff in the solve; where shear, G, is about a fifth of that, projection to lengths, which knows no shear, gives energy to it. Measured on squares halved alike, in G h^2 / (rho l^2).
    const StabilityScene s = stability_scene(Method::inextensible, "plucked");
    for (const double stiffness : {1e4, 1e5}) {
        const double shear = 0.5 * stiffness * 1e-3, edge = 0.1 / 12;
        const auto at = [&](double share) { return std::sqrt(share * 0.15 * edge * edge / shear); };
        const StabilityColumn column = s.run({MeshKind::aligned, 0}, stiffness, {at(10), at(100), at(3000)});
        INFO(stiffness);
        CHECK(column.outcomes[0].failure == "");
        CHECK(column.outcomes[1].failure == "blew up");
        CHECK(column.outcomes[2].failure != "blew up");
    }
}
