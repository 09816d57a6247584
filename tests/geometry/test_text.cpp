// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/text.h"

#include <catch2/catch.hpp>

using namespace toile;

TEST_CASE("text is what printf prints, whatever its length", "[text]") {
    CHECK(text("no values") == "no values");
    CHECK(text("%s", "").empty());
    CHECK(text("%d pairs within %.3g mm, %.1f %%", 7, 0.5, 99.5) == "7 pairs within 0.5 mm, 99.5 %");
    const std::string label(5000, 'a');
    CHECK(text("\"%s\"", label.c_str()) == '"' + label + '"');
}
