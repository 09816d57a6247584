// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/untangle.h"
#include "geometry/intersections.h"
#include "tests/support/random.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace toile;

namespace {

/// A square sheet of side 1 and n x n squares at height z(x, y), after those that are there.
template <class Z> void add_sheet(TriMesh& mesh, int n, Z&& z) {
    const int first = int(mesh.points.size());
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
            const double a = double(i) / n, b = double(j) / n;
            mesh.points.push_back({a, b, z(a, b)});
        }
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const int k = first + i * (n + 1) + j;
            mesh.triangles.push_back({k, k + n + 1, k + n + 2});
            mesh.triangles.push_back({k, k + n + 2, k + 1});
        }
}

double most_moved(const Points& a, const Points& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
    return most;
}

} // namespace

TEST_CASE("crossings of cloth with itself are taken apart") {
    TriMesh mesh;
    SECTION("a bump pressed through a sheet: the contour is a ring") {
        add_sheet(mesh, 20, [](double, double) { return 0.0; });
        add_sheet(mesh, 21, [](double a, double b) {
            return 0.08 - 0.12 * std::exp(-30 * ((a - 0.5) * (a - 0.5) + (b - 0.47) * (b - 0.47)));
        });
    }
    SECTION("a corner through a sheet: the contour ends at a border") {
        add_sheet(mesh, 20, [](double, double) { return 0.0; });
        add_sheet(mesh, 21, [](double a, double b) { return 0.3 - 0.2 * (a + b); });
    }
    SECTION("nothing crosses: nothing moves") {
        add_sheet(mesh, 10, [](double, double) { return 0.0; });
        add_sheet(mesh, 10, [](double a, double) { return 0.01 + 0.1 * a; });
        const Points before = mesh.points;
        const EdgeTable edges = make_edges(mesh.triangles, int(mesh.points.size()));
        const Untangled u = untangle({mesh.triangles, edges, 0.1}, mesh.points);
        CHECK(u.before == 0);
        CHECK(u.rounds == 0);
        CHECK(mesh.points == before);
        return;
    }
    const Points before = mesh.points;
    const EdgeTable edges = make_edges(mesh.triangles, int(mesh.points.size()));
    const Untangled u = untangle({mesh.triangles, edges, 0.05}, mesh.points);
    CAPTURE(u.rounds, u.before, u.after);
    CHECK(u.before > 0);
    CHECK(u.after == 0);
    CHECK(self_intersecting_pairs(mesh).empty());
    CHECK(most_moved(mesh.points, before) < 0.12);
}

TEST_CASE("a look at what has moved finds what a look at everything finds") {
    TriMesh mesh;
    add_sheet(mesh, 12, [](double, double) { return 0.0; });
    add_sheet(mesh, 13, [](double a, double b) { return 0.1 - 0.15 * a * b; });
    const EdgeTable edges = make_edges(mesh.triangles, int(mesh.points.size()));
    const TangledCloth cloth{mesh.triangles, edges, 0.08, {{0, 14, 15}}};
    test::Random random(11);
    CrossingFinder finder(cloth);
    int most = 0;
    for (int round = 0; round < 12; ++round) {
        const auto& near = finder.look(mesh.points);
        const auto all = find_crossings(cloth, mesh.points);
        REQUIRE(near.size() == all.size());
        for (std::size_t k = 0; k < all.size(); ++k) {
            CHECK(near[k].edge == all[k].edge);
            CHECK(near[k].triangle == all[k].triangle);
            CHECK(near[k].at.along == all[k].at.along);
        }
        most = std::max(most, int(all.size()));
        for (int k = 0; k < 20; ++k)
            mesh.points[std::size_t(random.in(0, double(mesh.points.size())))] += random.vec3(0.08);
    }
    CHECK(most > 50);
}

TEST_CASE("a tube through a sheet is drawn back through it, of which contours alone tell nothing") {
    TriMesh mesh;
    add_sheet(mesh, 30, [](double, double) { return 0.0; });
    const int first = int(mesh.points.size());
    TriMesh tube = test::tube(0.15, 0.6, 30, 20);
    for (const Vec3& p : tube.points) mesh.points.push_back({0.5 + p.x(), 0.51 + p.z(), p.y() - 0.47});
    for (const Triangle& t : tube.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    const EdgeTable edges = make_edges(mesh.triangles, int(mesh.points.size()));
    const TangledCloth cloth{mesh.triangles, edges, 0.035};
    const Points before = mesh.points;

    UntangleOptions plain;
    plain.max_rounds = 100;
    CHECK(untangle(cloth, mesh.points, plain).after > 0);
    mesh.points = before;
    UntangleOptions withdraw{0.3, 1};
    withdraw.withdraw = true;
    const Untangled u = untangle(cloth, mesh.points, withdraw);
    CAPTURE(u.rounds, u.before);
    CHECK(u.after == 0);
    CHECK(self_intersecting_pairs(mesh).empty());
    CHECK(most_moved(mesh.points, before) < 0.25); // 0.13 m were through
    // The root of the tube and the border of the sheet stay.
    for (std::size_t i = 0; i < before.size(); ++i)
        if (before[i].z() < -0.4 || (int(i) < first && (before[i] - Vec3(0.5, 0.5, 0)).norm() > 0.4))
            CHECK((mesh.points[i] - before[i]).norm() < 1e-9);
}

TEST_CASE("what does not come apart ends with the fewest crossings seen, after as many rounds as it is given") {
    TriMesh mesh;
    add_sheet(mesh, 8, [](double, double) { return 0.0; });
    const std::size_t half = mesh.triangles.size();
    for (std::size_t t = 0; t < half; ++t) mesh.triangles.push_back(mesh.triangles[t]); // given twice, on the same nodes
    add_sheet(mesh, 9, [](double a, double b) { return 0.3 - 0.5 * a - 0.1 * b; });
    const EdgeTable edges = make_edges(mesh.triangles, int(mesh.points.size()));
    UntangleOptions few;
    few.max_rounds = 2;
    const TangledCloth cloth{mesh.triangles, edges, 0.12};
    Points x = mesh.points;
    const Untangled u = untangle(cloth, x, few);
    CHECK(u.rounds <= 2);
    CHECK(u.after <= u.before);
    CHECK(int(find_crossings(cloth, x).size()) == u.after);
    int asked = 0;
    few.max_rounds = 400;
    few.go_on = [&] { return ++asked < 2; };
    CHECK(untangle(cloth, x, few).rounds <= 2);
}
