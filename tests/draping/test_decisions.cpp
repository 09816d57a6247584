// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/decisions.h"
#include "tests/support/flat_mesh.h"

#include <catch2/catch.hpp>

using namespace toile;
using Catch::Contains;

namespace {

std::string growth_sentence_of(const DrapeFacts& facts) {
    const test::FlatMesh sheet = test::jittered_rectangle(0.2, 0.1, 0.05, 0, 1);
    for (const std::string& s : decisions(facts, test::garment_of(sheet), test::flat_points(sheet), {fabric_preset("poplin")}, {}))
        if (s.starts_with("the body was")) return s;
    return "";
}

} // namespace

TEST_CASE("a body that was drawn in is told by level, and whether it grew back") {
    DrapeFacts facts;
    facts.edge_lengths = {0.06, 0.03};
    CHECK_THAT(growth_sentence_of(facts), Contains("never drawn in"));
    facts.drawn_in = {{0.03, 0.002}, {0.06, 0.0}};
    CHECK_THAT(growth_sentence_of(facts), Contains("grew back under contact") && Contains("2 mm at the level of 30 mm") && !Contains("60 mm"));
    facts.drawn_in = {{0.03, 0.002}, {0.06, 0.04}};
    CHECK_THAT(growth_sentence_of(facts), Contains(": 40 mm at the level of 60 mm, 2 mm at the level of 30 mm"));
    facts.still_drawn_in = 0.0125;
    CHECK_THAT(growth_sentence_of(facts), Contains("did not grow back whole") && Contains("12.5 mm are left"));
}
