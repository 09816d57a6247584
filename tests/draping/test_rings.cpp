// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/rings.h"

#include "draping/place.h"
#include "tests/support/dress.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>

using namespace toile;
using namespace toile::test;

namespace {

/// A body with arms that reach between the sides of the dress's skirt.
TriMesh body_with_hands() {
    TriMesh body = box({-0.05, -0.5, -0.05}, {0.05, 0.5, 0.05});
    const TriMesh hands = box({-0.3, -0.02, -0.03}, {0.3, 0.02, 0.03});
    const int first = int(body.points.size());
    body.points.insert(body.points.end(), hands.points.begin(), hands.points.end());
    for (const Triangle& t : hands.triangles) body.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return body;
}

std::vector<bool> skirt(const Cloth& c, const TriMesh& body, double armpit = 0.25) {
    return skirt_round_arms(c.garment, c.x, body, seams_through_body(c.garment, c.x, body), armpit);
}

} // namespace

TEST_CASE("a front and a back go round: their sides have one turn between them, whatever the axis is called zero") {
    Cloth c;
    add_front(c, {0, 0, 0.1});
    add_back(c, {0, 0, -0.1});
    sew_sides(c, 0, 1);
    for (std::size_t k = 0; k < c.garment.stitches.size(); ++k) c.garment.stitches[k].seam = int(k % 2); // a side each
    const std::vector<int> turns = turns_at_seams(c.garment, c.x, Vec3::Zero());
    REQUIRE(turns.size() == 2);
    CHECK(std::abs(turns[0] - turns[1]) == 1);
    const std::vector<int> beside = turns_at_seams(c.garment, c.x, Vec3(1, 0, 0)); // the axis is not between the panels
    CHECK(beside[0] == beside[1]);
}

TEST_CASE("the middle of a panel is that of its area") {
    Cloth c;
    add_front(c, {0.3, 0.1, 0.2});
    add_back(c, {0, -1, 0});
    const std::vector<Vec3> middles = panel_middles(c.garment, c.x);
    CHECK((middles[0] - Vec3(0.3, 0.1, 0.2)).norm() < 1e-12);
    CHECK((middles[1] - Vec3(0, -1, 0)).norm() < 1e-12);
}

TEST_CASE("a skirt with the hands between its sides is told, with what hangs from it, and not the bodice above it") {
    const Cloth c = dress(true);
    CHECK(skirt(c, body_with_hands()) == std::vector<bool>{false, false, true, true, true, true});
}

TEST_CASE("there is no skirt to be told where nothing is in the way, nothing is above it, or it hangs from above the armpits") {
    const auto none = [](const std::vector<bool>& marked) { return std::count(marked.begin(), marked.end(), true) == 0; };
    const Cloth c = dress(true);
    CHECK(none(skirt(c, box({-0.05, -0.5, -0.05}, {0.05, 0.5, 0.05}))));
    CHECK(none(skirt(c, body_with_hands(), 0.05)));
    Cloth tube;
    add_front(tube, {0, 0, 0.1});
    add_back(tube, {0, 0, -0.1});
    sew_sides(tube, 0, 1);
    CHECK(none(skirt(tube, body_with_hands())));
}
