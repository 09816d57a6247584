// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/rest/consistency.h"
#include "draping/rest/nearest.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace toile;

namespace {

// Four triangles round point 0, a square of side 1 seen from above, each with the outline running counterclockwise.
const std::vector<Triangle> fan{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};

Points pyramid(double height, std::array<double, 4> rim = {0, 0, 0, 0}) {
    return {{0, 0, height}, {0.5, 0.5, rim[0]}, {-0.5, 0.5, rim[1]}, {-0.5, -0.5, rim[2]}, {0.5, -0.5, rim[3]}};
}

/// The square flat, its spokes longer by a factor, and all ridges of one angle (rad).
Prescribed square(double spokes, double ridge, double length_weight) {
    Prescribed data = measured(fan, pyramid(0));
    for (int e = 0; e < data.edges.size(); ++e) {
        if (data.edges.ends[e][0] != 0) continue;
        data.length[e] *= spokes;
        data.angle[e] = ridge;
    }
    data.length_weight.assign(data.edges.size(), length_weight);
    return data;
}

double degrees(double rad) { return rad * 180 / M_PI; }

} // namespace

TEST_CASE("nearest shape: four triangles with four ridges of 30 degrees") {
    // Reference: least squares over the same data from many starts, polished to a gradient of 1e-8.
    const double ridge = M_PI / 6;
    for (const auto& [weight, energy] : {std::pair{1.0, 0.00274135244}, {1000.0, 0.4253912878}}) {
        const Prescribed data = square(1, ridge, weight);
        const NearestShape a = nearest_shape(data, pyramid(0.1, {0, -0.05, 0.01, -0.04}));
        const NearestShape b = nearest_shape_lbfgs(data, pyramid(0.1, {0, -0.05, 0.01, -0.04}));
        CAPTURE(weight, a.iterations, b.iterations, a.gradient, b.gradient);
        CHECK(a.end == NearestEnd::minimum);
        CHECK(a.energy == Approx(energy).epsilon(1e-8));
        CHECK(b.energy == Approx(a.energy).epsilon(1e-6));
    }
}

TEST_CASE("nearest shape: an eased cone has two states, each the mirror of the other") {
    const Prescribed data = square(1.05, 0, 1000);
    const auto shapes = nearest_shapes(data, pyramid(0.2));
    REQUIRE(shapes.size() >= 2);
    for (int k = 0; k < 2; ++k) {
        CHECK(shapes[k].shape.energy == Approx(1.3160316331).epsilon(1e-8));
        CHECK(shapes[k].mirror == 1 - k);
        for (const Hinge& h : hinges_of(data.edges, fan))
            CHECK(std::abs(degrees(angles_of(data, shapes[k].shape.x)[h.edge])) == Approx(31.748).margin(1e-3));
    }
}

TEST_CASE("prescribed data: nine of the twelve of four triangles are independent") {
    const Points x = pyramid(0.3, {0.02, -0.01, 0.03, 0.05});
    const DataCount count = count_data(measured(fan, x), x);
    CHECK(count.lengths == 8);
    CHECK(count.angles == 4);
    CHECK(count.inner_points == 1);
    CHECK(count.freedom == 9);
    CHECK(count.rank == 9);
}

TEST_CASE("prescribed data: what is measured fits, what is changed does not") {
    const Points x = pyramid(0.3, {0.02, -0.01, 0.03, 0.05});
    Prescribed data = measured(fan, x);
    CHECK(misfit(data)[0] == Approx(0).margin(1e-7));
    const NearestShape own = nearest_shape(data, x);
    CHECK(own.energy == Approx(0).margin(1e-20));
    // A flat square with four ridges of 30 degrees: by symmetry each quarter turn tilts by 30 degrees, and the rotation left
    // over is that of (Rz(90) Rx(30))^4.
    data = square(1, M_PI / 6, 1);
    const double half = std::acos(std::cos(M_PI / 4) * std::cos(M_PI / 12)); // of the rotation of one quarter
    CHECK(misfit(data)[0] == Approx(std::abs(std::remainder(8 * half, 2 * M_PI))).epsilon(1e-9));
    CHECK(angle_defects(data)[0] == Approx(0).margin(1e-9));
    data.length[0] = 10;
    CHECK_THROWS_WITH(misfit(data), Catch::Matchers::Contains("no triangle has the lengths prescribed for points"));
}

TEST_CASE("nearest shape: a ball without seams rests as a sphere") {
    const TriMesh ball = test::sphere(0.036, 3);
    const Prescribed data = measured(ball.triangles, ball.points);
    double defects = 0;
    for (const double d : angle_defects(data)) defects += d;
    CHECK(defects == Approx(4 * M_PI).epsilon(1e-12));
    for (const double off : misfit(data)) CHECK(off < 1e-6);
    const NearestShape found = nearest_shape(data, shaken(data, ball.points, 0.3, 7));
    CHECK(found.end == NearestEnd::minimum);
    CHECK(found.energy < 1e-20);
    Vec3 centre = Vec3::Zero();
    for (const Vec3& p : found.x) centre += p / double(found.x.size());
    for (const Vec3& p : found.x) CHECK((p - centre).norm() == Approx(0.036).epsilon(1e-7));
}

TEST_CASE("nearest shape: flat cloth does not become a ball") {
    // The lengths of a sphere with no angles at all: lengths alone hold its shape, and what is asked of the angles is frozen in.
    const TriMesh ball = test::sphere(0.036, 2);
    Prescribed data = measured(ball.triangles, ball.points);
    data.angle.assign(data.angle.size(), 0.0);
    data.length_weight.assign(data.length_weight.size(), 1e4);
    const NearestShape found = nearest_shape(data, ball.points);
    CHECK(found.end == NearestEnd::minimum);
    double squares = 0;
    for (const Hinge& h : hinges_of(data.edges, data.triangles)) {
        const double a = measured(ball.triangles, ball.points).angle[h.edge];
        squares += a * a;
    }
    CHECK(found.energy == Approx(squares).epsilon(0.01));
}
