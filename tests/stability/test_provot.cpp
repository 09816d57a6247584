// SPDX-License-Identifier: GPL-3.0-or-later
// Limits on elongation: what a sweep leaves depends on its order.

#include "draping/stability/boundary.h"
#include "tests/stability/scenes.h"

#include <algorithm>

using namespace toile;
using namespace toile::test;

namespace {

double most(const std::vector<double>& excess) { return *std::max_element(excess.begin(), excess.end()); }

} // namespace

TEST_CASE("stability: swept from the held end a chain keeps all excess but that of its last link") {
    const std::vector<double> left = limited_chain(12, ChainOrder::from_held_end, 1);
    for (int i = 0; i < 11; ++i) CHECK(left[i] == 1);
    CHECK(left[11] == 0);
}

TEST_CASE("stability: swept from the free end a chain puts twice the excess into its second link") {
    // A link is too long by p when its turn comes: 1 of its own and half of the one below, 2 - 2^-j after j of them.
    const std::vector<double> left = limited_chain(12, ChainOrder::from_free_end, 1);
    CHECK(left[0] == 0);
    CHECK(left[1] == Approx(2 - std::pow(2, -11)));
    for (int i = 2; i < 12; ++i) CHECK(left[i] == Approx((2 - std::pow(2, -(12 - i))) / 2));
}

TEST_CASE("stability: the excess of strips is that of the chain after any number of sweeps in either order") {
    for (const auto& [name, order] : {std::pair{"held", ChainOrder::from_held_end}, {"free", ChainOrder::from_free_end}}) {
        const StabilityScene s = stability_scene(Method::springs_limited, std::string("overstretched, swept from the ") + name + " end");
        // A corner with two triangles has two thirds of the mass of a node between; the other corners are lighter and their chains shorter.
        const std::vector<double> sweeps{1, 2, 5, 20, 100, 200};
        const StabilityColumn column = s.run({MeshKind::aligned, 0}, 1e4, sweeps);
        for (std::size_t k = 0; k < sweeps.size(); ++k) {
            INFO(name << " end, " << sweeps[k] << " sweeps");
            CHECK(column.outcomes[k].measure == Approx(most(limited_chain(12, order, int(sweeps[k]), 2.0 / 3))).epsilon(0.01));
        }
        CHECK(check_boundary(s, {{MeshKind::aligned, 0}}, {1e2, 1e7}, 0.98, 1.02) == 2); // a sweep or two of 150
    }
}

TEST_CASE("stability: limits take sweeps by the square of their rows") {
    for (const ChainOrder order : {ChainOrder::from_held_end, ChainOrder::from_free_end})
        CHECK(limit_sweeps(80, order, 0.1) / double(limit_sweeps(40, order, 0.1)) == Approx(4).epsilon(0.05));
}
