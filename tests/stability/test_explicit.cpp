// SPDX-License-Identifier: GPL-3.0-or-later
// Symplectic Euler: 2 / w of the fastest motion.

#include "tests/stability/scenes.h"

using namespace toile;
using namespace toile::test;

TEST_CASE("stability: explicit springs blow up from 2 / w on and not before on every mesh") {
    // 2 %: w by Lanczos is up to half a percent low, and a motion at the bound itself takes forever to grow.
    const StabilityScene s = stability_scene(Method::springs_explicit, "swing");
    CHECK(check_boundary(s, stability_meshes(5), {1e4, 1e6}, 0.98, 1.02) == 36);
    CHECK(check_boundary(s, stability_meshes(0), {1e3, 1e7}, 0.98, 1.02) == 6);
}

TEST_CASE("stability: limits that are not met leave explicit springs their boundary") {
    CHECK(check_boundary(stability_scene(Method::springs_limited, "swing"), stability_meshes(1), {1e5}, 0.98, 1.02) == 6);
}
