// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/elastic.h"

#include "tests/support/energy_checks.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

TEST_CASE("an elastic band pulls by its strain and never pushes") {
    const std::vector<ElasticSegment> band{{0, 1, 0.08, 40}};
    const Points taut{Vec3(0, 1, 0), Vec3(0.1, 1, 0)}, slack{Vec3(0, 1, 0), Vec3(0.079, 1, 0)};
    Eigen::VectorXd g = Eigen::VectorXd::Zero(6);
    add_gradient(band, taut, g);
    CHECK(strain(band[0], taut) == Approx(0.25));
    CHECK(g[3] == Approx(10)); // 40 N per unit strain
    CHECK(g[0] == Approx(-10));
    CHECK(value(band, taut) == Approx(0.5 * 40 * 0.08 * 0.25 * 0.25));
    g.setZero();
    add_gradient(band, slack, g);
    CHECK(g.norm() == 0);
    CHECK(value(band, slack) == 0);
    BlockMatrix h = full_matrix(2);
    add_hessian(band, slack, h);
    CHECK(dense(h).norm() == 0);
}
