// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/inspect.h"
#include "draping/untangle_garment.h"
#include "geometry/parallel.h"
#include "tests/support/mesh_cloth.h"
#include "tests/support/random.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace toile;
using test::Cloth;
using test::cloth_of;

namespace {

struct Untangling {
    Inspection before, after;
    UntangledGarment result;
};

Untangling untangled(const Cloth& c, const TriMesh& body) {
    Untangling u;
    u.before = inspect(c.garment, c.x, body);
    u.result = untangle_garment(c.garment, c.x, body);
    u.after = inspect(c.garment, u.result.x, body);
    return u;
}

/// Nothing crosses any more; what it moved at most, m, and by how much edges have changed at most and in the mean.
void check_clear(const Untangling& u, double moved, double edge_largest, double edge_mean) {
    CHECK(u.before.intersections.cloth_avatar + u.before.intersections.cloth_cloth > 0);
    CHECK(u.result.status == UntangleStatus::clear);
    CHECK(u.after.intersections.cloth_avatar == 0);
    CHECK(u.after.intersections.cloth_cloth == 0);
    CHECK(u.after.inside.nodes == 0);
    CHECK(u.after.crossings.empty());
    CHECK(u.result.change.largest < moved);
    CHECK(u.result.change.edge_largest < edge_largest);
    CHECK(u.result.change.edge_mean < edge_mean);
}

} // namespace

TEST_CASE("two sheets that cross", "[untangle_garment]") {
    TriMesh mesh = test::grid(24, 24, 0.01);
    TriMesh other = test::grid(25, 25, 0.0097);
    for (Vec3& p : other.points) p.z() = 0.02 - 0.15 * p.x() + 0.03 * p.y();
    test::append(mesh, other);
    check_clear(untangled(cloth_of(mesh), {}), 0.02, 0.01, 0.001);
}

TEST_CASE("a sleeve through a part of a torso", "[untangle_garment]") {
    TriMesh mesh = test::tube(0.2, 0.5, 80, 32); // the torso
    TriMesh sleeve = test::tube(0.06, 0.3, 24, 20);
    for (Vec3& p : sleeve.points) p = Vec3(0.17 + p.y(), 0.25 + p.x(), p.z() + 0.003);
    test::append(mesh, sleeve); // its end is 3 cm and more in the torso
    check_clear(untangled(cloth_of(mesh), {}), 0.06, 0.1, 0.005);
}

TEST_CASE("a fold pushed through itself", "[untangle_garment]") {
    // A sheet folded over, the upper layer pressed through the lower one by a dent.
    TriMesh mesh = test::grid(60, 25, 0.01);
    for (Vec3& p : mesh.points) {
        const double s = p.x(), r = 0.02;
        const double dent = 0.06 * std::exp(-((s - 0.52) * (s - 0.52) + (p.y() - 0.12) * (p.y() - 0.12)) / 0.0018);
        if (s < 0.27)
            p = Vec3(s, p.y(), 0);
        else if (s < 0.27 + EIGEN_PI * r)
            p = Vec3(0.27 + r * std::sin((s - 0.27) / r), p.y(), r - r * std::cos((s - 0.27) / r));
        else
            p = Vec3(0.27 - (s - 0.27 - EIGEN_PI * r), p.y(), 2 * r - dent);
    }
    check_clear(untangled(cloth_of(mesh), {}), 0.03, 0.1, 0.005);
}

TEST_CASE("a tube pushed 5 mm into a sphere", "[untangle_garment]") {
    const TriMesh body = test::ellipsoid({0.15, 0.15, 0.15}, 40, 30);
    TriMesh mesh = test::tube(0.146, 0.2, 60, 20);
    for (Vec3& p : mesh.points) p += Vec3(0.001, -0.1, 0);
    const Untangling u = untangled(cloth_of(mesh), body);
    CHECK(u.before.inside.nodes > 100);
    CHECK(u.before.inside.depth == Approx(0.005).epsilon(0.2));
    check_clear(u, 0.008, 0.1, 0.02);
    CHECK(u.after.clearance > 0.04e-3);
}

TEST_CASE("a corner deep in a body and cloth crossing itself elsewhere", "[untangle_garment]") {
    const TriMesh body = test::ellipsoid({0.15, 0.15, 0.15}, 40, 30);
    TriMesh mesh = test::grid(40, 30, 0.01);
    for (Vec3& p : mesh.points) p = Vec3(p.x() + 0.07, p.y() - 0.15, p.z() + 0.02); // 8 cm deep at its edge
    TriMesh other = test::grid(8, 8, 0.0102);
    for (Vec3& p : other.points) p = Vec3(0.3903 + 0.3 * p.x(), 0.05 + p.y(), p.x() - 0.02);
    test::append(mesh, other);
    const Untangling u = untangled(cloth_of(mesh), body);
    CHECK(u.before.inside.depth > 0.05);
    check_clear(u, 0.12, 0.2, 0.01);
}

TEST_CASE("a garment that crosses nothing comes back as it is", "[untangle_garment]") {
    const TriMesh body = test::ellipsoid({0.1, 0.1, 0.1}, 20, 15);
    const Cloth c = cloth_of(test::tube(0.12, 0.2, 40, 10));
    const UntangledGarment u = untangle_garment(c.garment, c.x, body);
    CHECK(u.status == UntangleStatus::clear);
    CHECK(u.x == c.x);
    CHECK(u.change.moved == 0);
    CHECK(u.decisions.empty());
}

TEST_CASE("cloth far from what crosses stays to the bit, and threads change nothing", "[untangle_garment]") {
    TriMesh mesh = test::grid(60, 8, 0.01);
    TriMesh other = test::grid(4, 4, 0.0102);
    for (Vec3& p : other.points) p = Vec3(0.021 + 0.3 * p.x(), 0.021 + p.y(), p.x() - 0.02);
    test::append(mesh, other);
    const Cloth c = cloth_of(mesh);
    const UntangledGarment u = untangle_garment(c.garment, c.x, {});
    CHECK(u.status == UntangleStatus::clear);
    for (std::size_t i = 0; i < c.x.size(); ++i)
        if (c.x[i].x() > 0.3) CHECK(u.x[i] == c.x[i]);
    set_threads(1);
    const UntangledGarment alone = untangle_garment(c.garment, c.x, {});
    set_threads(0);
    CHECK(alone.x == u.x);
}

TEST_CASE("what cannot be undone is said, and the best state returned", "[untangle_garment]") {
    const TriMesh body = test::ellipsoid({0.1, 0.1, 0.1}, 20, 15);
    SECTION("a sheet right through the middle of the body") {
        TriMesh mesh = test::grid(40, 40, 0.01);
        for (Vec3& p : mesh.points) p -= Vec3(0.2, 0.2, 0);
        const Untangling u = untangled(cloth_of(mesh), body);
        CHECK(u.result.crossings == u.after.intersections.cloth_avatar + u.after.intersections.cloth_cloth);
        CHECK(u.result.inside == u.after.inside.nodes);
        CHECK(u.after.intersections.cloth_avatar <= u.before.intersections.cloth_avatar);
    }
    SECTION("cloth given twice") {
        TriMesh mesh = test::grid(4, 4, 0.01);
        mesh.triangles.push_back(mesh.triangles[5]);
        const Untangling u = untangled(cloth_of(mesh), {});
        CHECK(u.result.status == UntangleStatus::tangled);
        CHECK(u.after.intersections.cloth_cloth > 0);
        CHECK(u.result.crossings == u.after.intersections.cloth_cloth);
    }
    SECTION("no time") {
        TriMesh mesh = test::tube(0.09, 0.2, 40, 10);
        for (Vec3& p : mesh.points) p.y() -= 0.1;
        const Cloth c = cloth_of(mesh);
        UntangleGarmentOptions o;
        o.max_seconds = 1e-9;
        const UntangledGarment u = untangle_garment(c.garment, c.x, body, o);
        CHECK(u.status == UntangleStatus::limit);
        CHECK(u.crossings + u.inside > 0);
    }
}
