// SPDX-License-Identifier: GPL-3.0-or-later
// What maps are made over: jittered meshes, and values at equal ratios.

#include "tests/stability/scenes.h"

using namespace toile;
using namespace toile::test;

TEST_CASE("stability: jitter moves what is inside by no more than it is told and leaves the border and every triangle") {
    const SheetMesh mesh = sheet_mesh(MeshKind::alternating, 0.1, 0.05, 0.01);
    const SheetMesh a = jittered(mesh, 0.2, 1), b = jittered(mesh, 0.2, 2);
    int moved = 0;
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const Vec2& p = mesh.points[i];
        const bool border = p.x() < 1e-9 || p.x() > 0.1 - 1e-9 || p.y() < 1e-9 || p.y() > 0.05 - 1e-9;
        const Vec2 off = a.points[i] - p;
        CHECK(off.cwiseAbs().maxCoeff() <= (border ? 0 : 0.2 * 0.01 * (1 + 1e-9)));
        if (!border) moved += off.norm() > 0 && a.points[i] != b.points[i];
    }
    CHECK(moved == 9 * 4);
    for (const Triangle& t : a.triangles) {
        const Vec2 u = a.points[t[1]] - a.points[t[0]], v = a.points[t[2]] - a.points[t[0]];
        CHECK(u.x() * v.y() - u.y() * v.x() > 0);
    }
}

TEST_CASE("stability: values rise at equal ratios and counts are whole") {
    const std::vector<double> values = spread_values(1e-2, 1e2, 5, false);
    REQUIRE(values.size() == 5);
    for (int k = 0; k < 5; ++k) CHECK(values[k] == Approx(std::pow(10, k - 2)));
    CHECK(spread_values(1, 4, 7, true) == std::vector<double>{1, 2, 3, 4});
}

TEST_CASE("stability: every method has a scene") {
    for (const Method m : all_methods()) {
        INFO(to_string(m));
        int scenes = 0;
        for (const StabilityScene& s : stability_scenes()) scenes += s.method == m;
        CHECK(scenes > 0);
    }
}
