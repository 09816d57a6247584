// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/inside.h"
#include "tests/support/random.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace toile;

namespace {

/// The same by solid angles (van Oosterom and Strackee, 1983), in plain floating point.
double winding_by_angles(const TriMesh& m, const Vec3& p) {
    double sum = 0;
    for (const Triangle& t : m.triangles) {
        const Vec3 a = m.points[t[0]] - p, b = m.points[t[1]] - p, c = m.points[t[2]] - p;
        const double la = a.norm(), lb = b.norm(), lc = c.norm();
        sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
    return sum / (4 * EIGEN_PI);
}

TriMesh box() {
    TriMesh m;
    for (int i = 0; i < 8; ++i) m.points.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2)});
    m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return m;
}

void append(TriMesh& to, const TriMesh& part, const Vec3& at) {
    const int first = int(to.points.size());
    for (const Vec3& p : part.points) to.points.push_back(p + at);
    for (const Triangle& t : part.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

} // namespace

TEST_CASE("points in two solids that overlap count twice, by rays as by solid angles") {
    TriMesh m = test::ellipsoid({0.3, 0.5, 0.2}, 20, 13);
    append(m, test::ellipsoid({0.2, 0.2, 0.2}, 15, 9), {0.3, 0.1, 0.05});
    test::Random random(5);
    Points points;
    for (int k = 0; k < 2000; ++k) points.push_back(random.vec3(0.6));
    const std::vector<int> winding = winding_numbers(m, points);
    int twice = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        CHECK(winding[i] == Approx(winding_by_angles(m, points[i])).margin(1e-6));
        twice += winding[i] == 2;
    }
    CHECK(twice > 10);
}

TEST_CASE("rays through edges and corners count once") {
    const TriMesh m = box();
    // Upward of these points lie a corner, edges of the box and the diagonals of its faces.
    const Points inside{{0.5, 0.5, 0.5}, {0.25, 0.75, 0.1}, {0.75, 0.25, 0.9}, {1e-300, 0.5, 0.5}};
    const Points outside{{0, 0, -1}, {1, 1, -1}, {0, 0.5, -1}, {0.5, 1, -1}, {0.5, 0.5, -1}, {1, 0.5, -3}, {0.5, 0.5, 2}, {-1e-300, 0.5, 0.5}};
    for (const int w : winding_numbers(m, inside)) CHECK(w == 1);
    for (const int w : winding_numbers(m, outside)) CHECK(w == 0);
    const Points on{{0, 0, 0}, {0.5, 0, 0}, {0.5, 0.5, 0}, {0.5, 0.5, 1}, {0.3, 0.2, 1}, {0, 0.5, 0.5}};
    for (const int w : winding_numbers(m, on)) CHECK((w == 0 || w == 1));
    TriMesh turned = m;
    for (Triangle& t : turned.triangles) std::swap(t[0], t[1]);
    for (const int w : winding_numbers(turned, inside)) CHECK(w == -1);
}

TEST_CASE("depth is the distance to the nearest place of the surface") {
    const std::vector<double> d = surface_distances(box(), {{0.5, 0.5, 0.25}, {0.1, 0.5, 0.5}, {2, 0.5, 0.5}, {2, 2, 0.5}});
    CHECK(d[0] == Approx(0.25));
    CHECK(d[1] == Approx(0.1));
    CHECK(d[2] == Approx(1));
    CHECK(d[3] == Approx(std::sqrt(2.0)));
    CHECK(surface_distances({}, {{0, 0, 0}})[0] == std::numeric_limits<double>::infinity());
    CHECK_THROWS_AS(winding_numbers(box(), {{0, 0, std::numeric_limits<double>::quiet_NaN()}}), std::invalid_argument);
}
