// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/wait.h"

#include "tests/support/sewn_squares.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

namespace {

enum Seam { bodice_sides, front_waist, back_waist, skirt_sides, front_hem, back_hem, flounce_sides, seams };

/// Front and back of a bodice, of a skirt below it and of a flounce below that.
Cloth dress(bool labelled) {
    Cloth c;
    for (const double y : {0.2, 0.0, -0.2}) {
        add_front(c, {0, y, 0.1});
        add_back(c, {0, y, -0.1});
    }
    const auto sew_next = [&](Seam seam, auto&& sew) {
        const std::size_t before = c.garment.stitches.size();
        sew();
        for (std::size_t k = before; k < c.garment.stitches.size(); ++k) c.garment.stitches[k].seam = seam;
    };
    sew_next(bodice_sides, [&] { sew_sides(c, 0, 1); });
    sew_next(front_waist, [&] { sew_below(c, 0, 2); });
    sew_next(back_waist, [&] { sew_below(c, 1, 3); });
    sew_next(skirt_sides, [&] { sew_sides(c, 2, 3); });
    sew_next(front_hem, [&] { sew_below(c, 2, 4); });
    sew_next(back_hem, [&] { sew_below(c, 3, 5); });
    sew_next(flounce_sides, [&] { sew_sides(c, 4, 5); });
    if (labelled) c.garment.borders.push_back({"left_collar", 0, 0, {0, 1}, {0, 1}});
    return c;
}

/// Between the sides of the skirt alone.
const TriMesh hips = box({-0.15, -0.05, -0.05}, {0.15, 0.05, 0.05});

} // namespace

TEST_CASE("sides with the body between them wait, and those of what hangs by them") {
    const Cloth c = dress(true);
    const Waiting w = what_waits(c.garment, c.x, hips, 1e-3);
    REQUIRE(w.seams.size() == seams);
    for (int s = 0; s < seams; ++s) CHECK(bool(w.seams[s]) == (s == skirt_sides || s == flounce_sides));
    CHECK(w.outside == std::vector<bool>{false, false, true, true, true, true});
}

TEST_CASE("without a labelled border nothing is known to hang by the waiting sides") {
    const Cloth c = dress(false);
    const Waiting w = what_waits(c.garment, c.x, hips, 1e-3);
    REQUIRE(w.seams.size() == seams);
    for (int s = 0; s < seams; ++s) CHECK(bool(w.seams[s]) == (s == skirt_sides));
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
