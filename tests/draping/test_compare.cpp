// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/compare.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace toile;

TEST_CASE("meshes of the same triangles are compared point by point") {
    const TriMesh a = test::grid(8, 6, 0.05);
    CHECK(compare(a, a).same_triangles);
    CHECK(compare(a, a).max == 0);

    TriMesh b = a;
    for (Vec3& p : b.points)
        p += Vec3(0.003, 0, 0.004); // partly within the plane: it counts
    CHECK(compare(a, b).rms == Approx(0.005));
    CHECK(compare(a, b).mean == Approx(0.005));
    CHECK(compare(a, b).max == Approx(0.005));

    // Distance that grows linearly from 0 to 1 cm: the mean square over the area is a third.
    TriMesh c = a;
    for (Vec3& p : c.points)
        p[2] = 0.01 * p[0] / 0.4;
    CHECK(compare(a, c).rms == Approx(0.01 / std::sqrt(3.0)));
    CHECK(compare(a, c).max == Approx(0.01));
    CHECK(compare(a, c).where[0] == Approx(0.4));
}

TEST_CASE("meshes of different resolution are compared surface to surface, both ways") {
    const TriMesh a = test::grid(8, 6, 0.05), b = test::grid(20, 15, 0.02, 0.007);
    const Comparison d = compare(a, b);
    CHECK_FALSE(d.same_triangles);
    CHECK(d.rms == Approx(0.007));
    CHECK(d.max == Approx(0.007));

    // One sheet is a tenth of a metre longer: seen from the longer one only.
    const TriMesh longer = test::grid(10, 6, 0.05);
    CHECK(compare(a, longer).max == Approx(0.1));
    CHECK(compare(longer, a).max == Approx(0.1));
    CHECK(compare(a, longer).rms == Approx(compare(longer, a).rms));
    CHECK(compare(a, longer).where[0] == Approx(0.5));

    // Refinements of one sphere come together as their edges squared.
    const TriMesh coarse = test::ellipsoid({0.5, 0.5, 0.5}, 40, 20),
                  fine = test::ellipsoid({0.5, 0.5, 0.5}, 160, 80);
    const double sag = 0.5 * (1 - std::cos(EIGEN_PI / 40));
    CHECK(compare(coarse, fine).max < 2.5 * sag);
    CHECK(compare(coarse, fine).max > 0.5 * sag);
}

TEST_CASE("what cannot be compared is refused") {
    const TriMesh a = test::grid(2, 2, 0.1);
    TriMesh broken = a;
    broken.points[0][0] = std::numeric_limits<double>::infinity();
    CHECK_THROWS_WITH(compare(a, {}), Catch::Contains("second mesh has no triangles"));
    CHECK_THROWS_WITH(compare(broken, a), Catch::Contains("first mesh has coordinates that are not finite"));
}
