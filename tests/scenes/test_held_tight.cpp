// SPDX-License-Identifier: GPL-3.0-or-later
// A band of poplin, which gives 3 %, starts where a body that tapers by 3 degrees is 5 % too wide for it. Friction would hold it there however
// hard it pulls (see validation/test_waistband.cpp), though it fits 10 cm higher.
#include "draping/drape.h"
#include "sewing/avatar.h"
#include "src/drape_input.h"
#include "tests/support/draw.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace toile;
using namespace toile::test;

TEST_CASE("a band that friction holds where it is too tight slides to where it fits") {
    constexpr double pi = std::numbers::pi;
    const Vec3 half(0.15, 0.6, 0.15); // m
    constexpr double low = 0.1, height = 0.05, short_by = 0.05;
    const auto radius = [&](double y) { return half.x() * std::sqrt(1 - y * y / (half.y() * half.y())); };
    const double width = pi * radius(low) / (1 + short_by);
    const Pattern pattern = test::tube(width, height);
    const Staging staging = stage(pattern, flat_of(pattern, 0.02));
    const TriMesh body = ellipsoid(half, 96, 200);
    DrapeOptions o;
    const Garment garment = close_seams(staging.levels.back().garment);
    o.from.resize(garment.node_count);
    for (std::size_t v = 0; v < garment.uv.size(); ++v) {
        const double round = pi * (garment.uv[v].x() / width + garment.panel_of_vertex[v]), y = low + garment.uv[v].y();
        const double r = radius(y) + 0.4e-3;
        o.from[garment.node_of_vertex[v]] = {-r * std::cos(round), y, r * std::sin(round)};
    }
    const DrapeResult held = drape(staging, {body, smoothed_toward_core(body, 0.01)}, PanelFabrics(2, fabric_preset("poplin")), o);
    INFO(held.where);
    CHECK(held.status == DrapeStatus::converged);
    for (const Vec3& p : held.state.positions) CHECK(p.y() > low + 0.02);
}
