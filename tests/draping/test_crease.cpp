// SPDX-License-Identifier: GPL-3.0-or-later
// Folds that are pressed into cloth.
#include "draping/energy/hinge.h"
#include "tests/support/cloth_scene.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace toile;
using namespace toile::test;

namespace {

/// A sheet in the plane z = 0, 0.2 m x 0.1 m, folded along its middle.
Garment folded_sheet(double edge, double angle) {
    Garment g = garment_of(halved_squares(int(std::lround(0.2 / edge)), int(std::lround(0.1 / edge)), edge));
    const auto on_fold = [&](int node) { return std::abs(g.uv[node].x() - 0.1) < 1e-9; };
    for (int e = 0; e < g.edges.size(); ++e)
        if (on_fold(g.edges.ends[e][0]) && on_fold(g.edges.ends[e][1])) g.rest.angles[e] = angle;
    return g;
}

Points flat_places(const Garment& g) {
    Points x;
    for (const Vec2& p : g.uv) x.push_back({p.x(), p.y(), 0});
    return x;
}

} // namespace

TEST_CASE("a crease is as stiff as a strip of its width, on any mesh", "[crease]") {
    const Fabric& fabric = fabric_preset("wool");
    for (const double edge : {0.05, 0.025, 0.0125}) {
        const Garment g = folded_sheet(edge, 2);
        const double expected = 0.5 * fabric.bend_weft * 0.1 / crease_width * 2 * 2;
        CHECK(value(make_creases(g, {fabric}), flat_places(g)) == Approx(expected).epsilon(1e-12));
    }
}

TEST_CASE("cloth that nothing holds folds to the angle that was pressed into it", "[crease]") {
    for (const double angle : {-2.0, 0.5, 2.8}) {
        INFO(angle);
        const Garment g = folded_sheet(0.025, angle);
        ClothScene s(g, {}, flat_places(g), fabric_preset("wool"), {0.3});
        s.problem->gravity = 0;
        REQUIRE(s.settle_to(1e-5, 500));
        int creases = 0;
        for (const Hinge& h : hinges_of(g)) {
            const auto& n = h.nodes;
            const double now = hinge_angle(n, s.x).value;
            CHECK(now == Approx(g.rest.angles[h.edge]).margin(1e-3));
            creases += is_crease(g, h.edge);
            if (!is_crease(g, h.edge)) continue;
            const Vec3 along = s.x[n[1]] - s.x[n[0]], front = along.cross(s.x[n[2]] - s.x[n[0]]);
            CHECK(front.dot(s.x[n[3]] - s.x[n[0]]) * angle < 0); // positive: away from the fabric's right side
        }
        CHECK(creases == 4);
        CHECK(s.crossings() == 0);
    }
}
