// SPDX-License-Identifier: GPL-3.0-or-later
// A sheet that hangs by two corners must not care how stiff its membrane is. The bar is for 10 mm, where
// bench/bench_bending.cpp has it on three meshes (docs/bending.md); twice as coarse, one mesh is within it too.

#include "tests/support/hanging_sheet.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

TEST_CASE("a sheet by two corners hangs alike for any stiffness of its membrane", "[validation]") {
    const std::vector<HungSheet> hung = hang_sheet(0.02, 1, {1e3, 1e4, 1e5});
    for (const HungSheet& h : hung) {
        REQUIRE(h.settled);
        CHECK(h.drop > 0.5); // more than the sheet is long: it folds
        CHECK(h.sag > 0.03);
        CHECK(farthest(hung[0], h) < 0.06 * hung[0].drop);
        CHECK(h.sag == Approx(hung[0].sag).epsilon(0.06));
    }
}
