// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/isosurface.h"
#include "geometry/parallel.h"
#include "geometry/solid.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace toile;

namespace {

const Eigen::AlignedBox3d unit_box(Vec3(-1, -1, -1), Vec3(1, 1, 1));

double smallest_angle(const TriMesh& mesh) {
    double smallest = EIGEN_PI;
    for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) {
            const Vec3 a = mesh.points[t[(k + 1) % 3]] - mesh.points[t[k]], b = mesh.points[t[(k + 2) % 3]] - mesh.points[t[k]];
            smallest = std::min(smallest, std::acos(a.normalized().dot(b.normalized())));
        }
    return smallest * 180 / EIGEN_PI;
}

int euler(const TriMesh& mesh) { return int(mesh.points.size()) - int(mesh.triangles.size()) / 2; }

} // namespace

TEST_CASE("a sphere comes out closed, round and with even triangles", "[isosurface]") {
    const auto ball = [](const Vec3& p) { return p.norm() - 0.7; };
    const TriMesh mesh = isosurface(ball, unit_box, {.cell = 0.05});
    CHECK(border_loops(mesh).empty());
    CHECK(euler(mesh) == 2);
    for (const Vec3& p : mesh.points) CHECK(p.norm() == Approx(0.7).epsilon(1e-5));
    CHECK(volume(mesh) == Approx(4.0 / 3 * EIGEN_PI * 0.343).epsilon(0.005));
    CHECK(smallest_angle(mesh) > 25);
}

TEST_CASE("a torus keeps its hole", "[isosurface]") {
    const auto torus = [](const Vec3& p) { return std::hypot(std::hypot(p.x(), p.y()) - 0.6, p.z()) - 0.2; };
    const TriMesh mesh = isosurface(torus, unit_box, {.cell = 0.04});
    CHECK(border_loops(mesh).empty());
    CHECK(euler(mesh) == 0);
    CHECK(volume(mesh) == Approx(2 * EIGEN_PI * EIGEN_PI * 0.6 * 0.04).epsilon(0.02));
}

TEST_CASE("a field that overstates distance loses no part", "[isosurface]") {
    // A disc 0.06 thick whose field is the distance scaled by up to two.
    const auto disc = [](const Vec3& p) {
        const double q = std::hypot(p.x() / 0.8, std::hypot(p.y() / 0.8, p.z() / 0.06));
        return 2 * (q - 1) * 0.06;
    };
    const TriMesh mesh = isosurface(disc, unit_box, {.cell = 0.03});
    CHECK(euler(mesh) == 2);
    CHECK(volume(mesh) == Approx(4.0 / 3 * EIGEN_PI * 0.8 * 0.8 * 0.06).epsilon(0.05));
}

TEST_CASE("a surface along the grid's diagonals is manifold all the same", "[isosurface]") {
    const auto rod = [](const Vec3& p) {
        const Vec3 along = Vec3(1, -1, 0).normalized();
        const double s = std::clamp(p.dot(along), -0.6, 0.6);
        return (p - s * along).cwiseAbs().maxCoeff() - 0.15;
    };
    const TriMesh mesh = isosurface(rod, unit_box, {.cell = 0.05});
    CHECK(crowded_edges(mesh) == 0);
    CHECK(euler(mesh) == 2);
}

TEST_CASE("the surface has the same bytes for any number of threads", "[isosurface]") {
    const auto ball = [](const Vec3& p) { return p.norm() - 0.7 + 0.05 * std::sin(9 * p.x()); };
    set_threads(1);
    const TriMesh one = isosurface(ball, unit_box, {.cell = 0.06});
    set_threads(2);
    const TriMesh two = isosurface(ball, unit_box, {.cell = 0.06});
    set_threads(0);
    CHECK(one.points == two.points);
    CHECK(one.triangles == two.triangles);
}
