// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/wait.h"

#include "tests/support/dress.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

namespace {

/// Between the sides of the skirt alone.
const TriMesh hips = box({-0.15, -0.05, -0.05}, {0.15, 0.05, 0.05});

} // namespace

TEST_CASE("sides with the body between them wait, and those of what hangs by them") {
    const Cloth c = dress(true);
    const Waiting w = what_waits(c.garment, c.x, hips, 1e-3);
    REQUIRE(w.seams.size() == seams);
    for (int s = 0; s < seams; ++s) CHECK(bool(w.seams[s]) == (s == skirt_left || s == skirt_right || s == flounce_left || s == flounce_right));
    CHECK(w.outside == std::vector<bool>{false, false, true, true, true, true});
}

TEST_CASE("without a labelled border nothing is known to hang by the waiting sides") {
    const Cloth c = dress(false);
    const Waiting w = what_waits(c.garment, c.x, hips, 1e-3);
    REQUIRE(w.seams.size() == seams);
    for (int s = 0; s < seams; ++s) CHECK(bool(w.seams[s]) == (s == skirt_left || s == skirt_right));
    CHECK(w.outside == std::vector<bool>{false, false, true, true, false, false});
}

TEST_CASE("nothing waits where nothing is in the way, where everything is, or when the sides are closed") {
    const Cloth c = dress(true);
    CHECK(what_waits(c.garment, c.x, box({-0.05, -0.3, -0.05}, {0.05, 0.3, 0.05}), 1e-3).seams.empty());
    CHECK(what_waits(c.garment, c.x, hips, 0.3).seams.empty());
    Cloth tube;
    add_front(tube, {0, 0, 0.1});
    add_back(tube, {0, 0, -0.1});
    sew_sides(tube, 0, 1);
    CHECK(what_waits(tube.garment, tube.x, hips, 1e-3).seams.empty());
}
