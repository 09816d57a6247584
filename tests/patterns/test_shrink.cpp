// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/shrink.h"
#include "patterns/curve.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace toile;

namespace {

/// A rectangle of 40 x 30 cm with a semicircle on its right.
Pattern rounded(const Vec2& shrink, double grain = EIGEN_PI / 2) {
    Panel panel;
    panel.name = "cloth";
    panel.shrink = shrink;
    panel.grain = grain;
    panel.outline = {{{0, 0}, {0.4, 0}, Straight{}, ""},
                     {{0.4, 0}, {0.4, 0.3}, Arc{0.15, false, true}, ""},
                     {{0.4, 0.3}, {0, 0.3}, Straight{}, ""},
                     {{0, 0.3}, {0, 0}, Straight{}, ""}};
    Pattern pattern;
    pattern.panels = {panel};
    return pattern;
}

double rest_length(const Pattern& p, int edge, double t0 = 0, double t1 = 1) { return length_at_rest(p, {0, edge, t0, t1}); }

} // namespace

TEST_CASE("cloth that is not shrunk has the lengths that it was cut with, to the last bit") {
    const Pattern p = rounded({0, 0});
    for (int e = 0; e < 4; ++e) CHECK(rest_length(p, e) == length(p.panels[0].outline[e]));
    CHECK((to_rest(p.panels[0]) - Mat2::Identity()).norm() == 0);
    CHECK(shrink_in_words(p.panels[0]).empty());
    CHECK(check(p).empty());
}

TEST_CASE("cloth shrinks along warp and weft, curves and parts of edges with it") {
    const Pattern p = rounded({0.1, 0.04});
    CHECK(rest_length(p, 0) == Approx(0.36));
    CHECK(rest_length(p, 3) == Approx(0.288));
    CHECK(rest_length(p, 0, 0.75, 0.25) == Approx(0.18));
    // Half an ellipse of half axes 0.135 and 0.144: Ramanujan's formula is better than 1e-9 there.
    const double a = 0.135, b = 0.144, h = std::pow((a - b) / (a + b), 2);
    CHECK(rest_length(p, 1) == Approx(M_PI / 2 * (a + b) * (1 + 3 * h / (10 + std::sqrt(4 - 3 * h)))).epsilon(1e-5));
    // The warp along the panel's x.
    const Pattern q = rounded({0.1, -0.04}, 0);
    CHECK(rest_length(q, 0) == Approx(0.416));
    CHECK(rest_length(q, 3) == Approx(0.27));
    CHECK(shrink_in_words(q.panels[0]) == "stretched by 4 % along the warp and shrunk by 10 % along the weft");

    Seam seam;
    seam.a = {{0, 0, 0, 1}};
    seam.b = {{0, 2, 1, 0}};
    CHECK(seam_lengths_at_rest(p, seam).ease == 0);
    seam.b = {{0, 2, 0.5, 0}};
    CHECK(seam_lengths_at_rest(p, seam).ease == Approx(1));
}

TEST_CASE("what steam does is noted, and what it cannot do is refused") {
    const std::vector<Issue> noted = check(rounded({0, 0.03}));
    REQUIRE(noted.size() == 1);
    CHECK(noted[0].severity == Severity::note);
    CHECK(noted[0].text == "Panel \"cloth\" is shrunk by 3 % along the warp after it is cut");
    for (const double share : {0.6, -0.6, std::nan("")}) {
        const std::vector<Issue> refused = check(rounded({share, 0}));
        REQUIRE(has_error(refused));
        CHECK(refused[0].text.find("from -0.5 to 0.5 was expected") != std::string::npos);
    }
}
