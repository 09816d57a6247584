// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/wrap.h"

#include "draping/place.h"
#include "draping/pull_shut.h"
#include "draping/rings.h"
#include "draping/staging.h"
#include "geometry/intersections.h"
#include "io/read_pattern.h"
#include "sewing/avatar.h"
#include "sewing/form.h"
#include "tests/support/full_skirt.h"

#include <catch2/catch.hpp>

#include <sstream>

using namespace toile;
using namespace toile::test;

namespace {

struct OpenSkirt {
    Garment garment;
    Points x;
    TriMesh body = make_form({});
    std::vector<bool> skirt;
};

OpenSkirt open_skirt(const nlohmann::json& file) {
    std::istringstream text(file.dump());
    const Pattern pattern = read_pattern(text, "skirt");
    TriangulateOptions options;
    options.edge_length = 0.04;
    options.levels = 1;
    const Staging staging = stage(pattern, triangulate(pattern, options));
    OpenSkirt s{staging.levels[0].garment, staging.levels[0].placed, make_form({}), {}};
    s.skirt = skirt_round_arms(s.garment, s.x, s.body, seams_through_body(s.garment, s.x, s.body), measure_body(s.body).armpit_y);
    return s;
}

bool of_skirt(const OpenSkirt& s, const Stitch& stitch) {
    return s.skirt[s.garment.panel_of_vertex[stitch.a]] && s.skirt[s.garment.panel_of_vertex[stitch.b[0]]];
}

} // namespace

TEST_CASE("a full skirt is laid round the body in pleats: closed, clear of the body and of itself, and as wide and long as it is cut") {
    for (const bool flounced : {false, true}) {
        CAPTURE(flounced);
        const OpenSkirt s = open_skirt(flounced ? flounced_skirt() : full_skirt());
        const std::optional<Points> laid = wrap_round(s.garment, s.x, s.body, s.skirt);
        REQUIRE(laid);
        Garment some = s.garment;
        std::erase_if(some.stitches, [&](const Stitch& stitch) { return !of_skirt(s, stitch); });
        CHECK(!some.stitches.empty());
        for (const Stitch& stitch : some.stitches) CHECK(stitch_gap(stitch, *laid) < 1e-9);
        std::vector<int> map;
        const Garment closed = close_seams(some, &map);
        TriMesh mesh{merge(closed, map, *laid), {}};
        for (int t = 0; t < int(closed.triangles.size()); ++t)
            if (s.skirt[closed.panel_of_triangle[t]]) mesh.triangles.push_back(closed.nodes(t));
        CHECK(self_intersecting_pairs(mesh).empty());
        CHECK(intersecting_pairs(mesh, s.body).empty());
        for (int i = 0; i < s.garment.node_count; ++i)
            if (!s.skirt[s.garment.panel_of_vertex[i]]) CHECK((*laid)[i] == s.x[i]);
        // Pleats take up what the cone lacks.
        double cut = 0, is = 0;
        for (int t = 0; t < int(s.garment.triangles.size()); ++t) {
            if (!s.skirt[s.garment.panel_of_triangle[t]]) continue;
            const Triangle v = s.garment.nodes(t);
            cut += rest_area(s.garment.rest.edges[t]);
            is += 0.5 * ((*laid)[v[1]] - (*laid)[v[0]]).cross((*laid)[v[2]] - (*laid)[v[0]]).norm();
        }
        CHECK(is / cut == Approx(1).margin(0.15));
    }
}

TEST_CASE("nothing is laid round where nothing is above it, or where panels do not go round") {
    const OpenSkirt s = open_skirt(full_skirt());
    CHECK(!wrap_round(s.garment, s.x, s.body, std::vector<bool>(s.skirt.size(), true)));
    std::vector<bool> front = s.skirt;
    *std::find(front.begin(), front.end(), true) = false;
    CHECK(!wrap_round(s.garment, s.x, s.body, front));
}
