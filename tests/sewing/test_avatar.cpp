// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/solid.h"
#include "sewing/avatar.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

using namespace toile;

TEST_CASE("an avatar moves on straight lines and arrives exactly", "[avatar]") {
    const Avatar avatar{test::sphere(1, 1), test::sphere(0.2, 1).points};
    CHECK(avatar.at(1) == avatar.body.points);
    CHECK(avatar.at(0)[3].isApprox(avatar.start[3]));
    CHECK(avatar.at(0.25)[7].norm() == Approx(0.4));
}

TEST_CASE("smoothing shrinks a sphere as the flow of its curvature says", "[avatar]") {
    // One implicit step on the sphere of radius r: L x = 2 x / r2, so x' = x / (1 + 2 t / r2).
    for (int rounds : {4, 5}) {
        const TriMesh ball = test::sphere(0.3, rounds);
        const Points smooth = smoothed_toward_core(ball, 0.01);
        double mean = 0;
        for (const Vec3& p : smooth) mean += p.norm() / double(smooth.size());
        CHECK(mean == Approx(0.3 / (1 + 2 * 0.01 / 0.09)).epsilon(rounds == 4 ? 4e-3 : 1e-3));
    }
    CHECK(smoothed_toward_core(test::sphere(1, 1), 0) == test::sphere(1, 1).points);
    CHECK_THROWS_AS(smoothed_toward_core(test::sphere(1, 1), -1), std::invalid_argument);
}

TEST_CASE("smoothing does not depend on how the body is meshed", "[avatar]") {
    TriMesh even = test::sphere(0.3, 5), uneven = even;
    for (Vec3& p : uneven.points) { // the same sphere, its points drawn toward one pole
        p.z() += 0.12;
        p = 0.3 * p.normalized();
    }
    const double a = volume({smoothed_toward_core(even, 0.01), even.triangles});
    const double b = volume({smoothed_toward_core(uneven, 0.01), uneven.triangles});
    CHECK(b == Approx(a).epsilon(0.02));
}

TEST_CASE("slivers and pieces of their own do no harm", "[avatar]") {
    TriMesh mesh = test::sphere(0.3, 3);
    // A point almost on an edge: two slivers.
    const Triangle t = mesh.triangles[0];
    mesh.points.push_back(0.5 * (mesh.points[t[0]] + mesh.points[t[1]]) + 1e-12 * mesh.points[t[2]]);
    const int m = int(mesh.points.size()) - 1;
    mesh.triangles[0] = {t[0], t[1], m};
    mesh.triangles.push_back({t[1], t[2], m});
    mesh.triangles.push_back({t[2], t[0], m});
    const TriMesh other = test::sphere(0.05, 2);
    const int first = int(mesh.points.size());
    for (const Vec3& p : other.points) mesh.points.push_back(p + Vec3(1, 0, 0));
    for (const Triangle& o : other.triangles) mesh.triangles.push_back({o[0] + first, o[1] + first, o[2] + first});

    const Points smooth = smoothed_toward_core(mesh, 0.01);
    for (int i = 0; i < int(smooth.size()); ++i) {
        REQUIRE(smooth[i].allFinite());
        CHECK((smooth[i] - (i < first ? Vec3(0, 0, 0) : Vec3(1, 0, 0))).norm() < (i < first ? 0.3 : 0.05));
    }
    CHECK((smooth[m] - 0.5 * (smooth[t[0]] + smooth[t[1]])).norm() < 1e-3);
}

TEST_CASE("what has no legs is not measured", "[avatar]") {
    CHECK_THROWS_AS(measure_body(test::box(Vec3(-0.2, 0, -0.1), Vec3(0.2, 1.7, 0.1))), std::invalid_argument);
    CHECK_THROWS_AS(measure_body(TriMesh{}), std::invalid_argument);
}

TEST_CASE("a tape measure reads the girth of a box", "[avatar]") {
    const TriMesh box = test::box(Vec3(-0.2, 0, -0.1), Vec3(0.2, 1.7, 0.1));
    CHECK(torso_girth(box, 1.0) == Approx(1.2));
    CHECK(torso_girth(box, 2.0) == 0);
}
