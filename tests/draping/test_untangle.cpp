// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/untangle.h"
#include "geometry/intersections.h"

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
