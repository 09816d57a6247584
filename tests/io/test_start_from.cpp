// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/start_from.h"
#include "io/write_garment.h"
#include "tests/support/skirt.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace toile;

namespace {

double largest_distance(const Points& a, const Points& b) {
    REQUIRE(a.size() == b.size());
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        worst = std::max(worst, (a[i] - b[i]).norm());
    return worst;
}

ReadGarment written(const test::Skirt& skirt, const std::string& name) {
    const test::TempFolder folder;
    write_garment(folder / name, skirt.garment, skirt.x);
    return read_garment(folder / name);
}

} // namespace

TEST_CASE("a drape starts from its own file where it ended") {
    const auto skirt = test::make_skirt(12, 8, 0.16, 1.0, 0.5);
    CHECK(largest_distance(start_from(written(skirt, "a.obj"), skirt.garment, "a"), skirt.x) < 1e-12);
    CHECK(largest_distance(start_from(written(skirt, "a.glb"), skirt.garment, "a"), skirt.x) < 1e-6);
}

TEST_CASE("another mesh of the same pattern starts on the earlier surface") {
    const auto coarse = test::make_skirt(12, 8, 0.16, 1.0, 0.5),
               fine = test::make_skirt(25, 17, 0.16, 1.0, 0.5);
    const Points x = start_from(written(coarse, "a.obj"), fine.garment, "a");
    // Within the sag of the coarse chords, r (1 - cos(pi / 24)).
    CHECK(largest_distance(x, fine.x) < 0.16 * (1 - std::cos(EIGEN_PI / 24)) + 2e-4);
}

TEST_CASE("a longer skirt continues the earlier one") {
    const auto shorter = test::make_skirt(12, 8, 0.16, 1.0, 0.5);
    auto longer = shorter;
    for (Vec2& p : longer.garment.uv)
        p.y() *= 1.04;
    const Points x = start_from(written(shorter, "a.obj"), longer.garment, "a");
    const auto top = [](const Points& p) {
        return std::max_element(p.begin(), p.end(),
                                [](const Vec3& a, const Vec3& b) { return a.y() < b.y(); })
            ->y();
    };
    CHECK(top(x) == Approx(1.02));
}

TEST_CASE("an earlier drape without the panel or without a pattern is refused") {
    auto skirt = test::make_skirt(6, 4, 0.16, 1.0, 0.5);
    const ReadGarment earlier = written(skirt, "a.obj");
    skirt.garment.panel_names[1] = "sleeve";
    CHECK_THROWS_WITH(start_from(earlier, skirt.garment, "a.obj"),
                      "a.obj has no panel 'sleeve' to start from");
    ReadGarment bare = earlier;
    bare.flat = false;
    CHECK_THROWS_AS(start_from(bare, earlier.garment, "a.obj"), InputError);
}
