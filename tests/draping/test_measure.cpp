// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/measure.h"
#include "draping/where.h"
#include "geometry/distance.h"
#include "tests/support/flat_mesh.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <limits>

using namespace toile;

namespace {

const test::FlatMesh sheet = test::jittered_rectangle(0.4, 0.3, 0.03, 0.2, 1);

Points mapped(const std::function<Vec3(const Vec2&)>& map) {
    Points x;
    for (const Vec2& p : sheet.points)
        x.push_back(map(p));
    return x;
}

/// A tube about the y axis as one panel whose two sides share their nodes, or with a gap of `open` radians.
struct Tube {
    Garment garment;
    Points x;
};

Tube tube_garment(double radius, double bottom, double height, int around, int along, double open = 0) {
    const double arc = 2 * EIGEN_PI - open;
    test::FlatMesh flat;
    for (int j = 0; j <= along; ++j)
        for (int i = 0; i <= around; ++i)
            flat.points.push_back({radius * arc * i / around, height * j / along});
    const auto at = [&](int j, int i) { return j * (around + 1) + i; };
    for (int j = 0; j < along; ++j)
        for (int i = 0; i < around; ++i) {
            flat.triangles.push_back({at(j, i), at(j, i + 1), at(j + 1, i + 1)});
            flat.triangles.push_back({at(j, i), at(j + 1, i + 1), at(j + 1, i)});
        }
    Tube tube = {test::garment_of(flat), {}};
    const bool closed = open == 0;
    Garment& g = tube.garment;
    for (int j = 0; j <= along; ++j)
        for (int i = 0; i <= around; ++i) {
            const double phi = -arc * i / around;
            if (closed && i == around) {
                g.node_of_vertex[at(j, i)] = g.node_of_vertex[at(j, 0)];
                continue;
            }
            g.node_of_vertex[at(j, i)] = int(tube.x.size());
            tube.x.push_back({radius * std::cos(phi), bottom + height * j / along, radius * std::sin(phi)});
        }
    g.node_count = int(tube.x.size());
    std::vector<Triangle> nodes;
    for (int t = 0; t < int(g.triangles.size()); ++t)
        nodes.push_back(g.nodes(t));
    g.edges = make_edges(nodes, g.node_count);
    g.seam_edge.assign(g.edges.size(), false);
    for (int e = 0; e < g.edges.size(); ++e) {
        const auto on_seam = [&](int n) { return closed && tube.x[n][2] == 0 && tube.x[n][0] > 0; };
        g.seam_edge[e] = on_seam(g.edges.ends[e][0]) && on_seam(g.edges.ends[e][1]);
    }
    return tube;
}

} // namespace

TEST_CASE("strain of a sheet that is moved only is none") {
    const Garment garment = test::garment_of(sheet, 0.4);
    const Eigen::AngleAxisd turn(1.1, Vec3(1, 2, 3).normalized());
    const Points x = mapped([&](const Vec2& p) { return Vec3(turn * Vec3(p[0], p[1], 0) + Vec3(1, 2, 3)); });
    const StrainMeasure s = measure_strain(garment, x, {});
    for (const Spread& k : {s.warp, s.weft, s.principal, s.shear}) {
        CHECK(k.max < 1e-13);
        CHECK(k.min > -1e-13);
        CHECK(k.p99 < 1e-13);
    }
    CHECK(s.compressed_area == 0);
}

TEST_CASE("strain of a stretched sheet is that of its deformation, along its own grain") {
    // The mesh's y is the warp; stretched by 3 % along x and pressed by 5 % along y.
    const Points x = mapped([](const Vec2& p) { return Vec3(1.03 * p[0], 0.95 * p[1], 0); });
    const StrainMeasure s = measure_strain(test::garment_of(sheet), x, {});
    CHECK(s.weft.min == Approx(0.03));
    CHECK(s.weft.max == Approx(0.03));
    CHECK(s.weft.p99 == Approx(0.03));
    CHECK(s.weft.mean == Approx(0.03));
    CHECK(s.warp.mean == Approx(-0.05));
    CHECK(s.warp.p99 == Approx(0.05));
    CHECK(s.principal.min == Approx(-0.05));
    CHECK(s.principal.max == Approx(0.03));
    CHECK(s.principal.mean == Approx(-0.01));
    CHECK(std::abs(s.shear.max) < 1e-12);
    CHECK(s.compressed_area == Approx(1));

    // With the grain turned by a right angle, warp and weft change places.
    const StrainMeasure turned = measure_strain(test::garment_of(sheet, EIGEN_PI / 2), x, {});
    CHECK(turned.warp.mean == Approx(0.03));
    CHECK(turned.weft.mean == Approx(-0.05));
}

TEST_CASE("shear is the angle by which warp and weft close, and a mirrored sheet has none") {
    const double angle = 0.1;
    const Points x =
        mapped([&](const Vec2& p) { return Vec3(p[0] + std::sin(angle) * p[1], std::cos(angle) * p[1], 0); });
    const StrainMeasure s = measure_strain(test::garment_of(sheet), x, {});
    CHECK(s.shear.min == Approx(angle));
    CHECK(s.shear.max == Approx(angle));
    CHECK(s.warp.max == Approx(0).margin(1e-12));
    CHECK(s.weft.max == Approx(0).margin(1e-12));
    // Simple shear by rotation of the warp: principal stretches sqrt(1 +- sin).
    CHECK(s.principal.max == Approx(std::sqrt(1 + std::sin(angle)) - 1));
    CHECK(s.principal.min == Approx(std::sqrt(1 - std::sin(angle)) - 1));
    CHECK(s.compressed_area == 0);
    CHECK(s.narrowed_area == Approx(1));

    const Points mirrored = mapped([](const Vec2& p) { return Vec3(-p[0], p[1], 0); });
    CHECK(measure_strain(test::garment_of(sheet), mirrored, {}).principal.p99 < 1e-12);
}

TEST_CASE("spread is weighted by area") {
    // Two triangles: a large one at rest, a small one (under 1 % of the area) stretched along the weft.
    const test::FlatMesh two = {{{0, 0}, {1, 0}, {0, 1}, {0, -0.005}}, {{0, 1, 2}, {0, 3, 1}}};
    Points x = test::flat_points(two);
    x[3] = Vec3(0, -0.0055, 0); // warp of the small triangle by 10 %
    const StrainMeasure s = measure_strain(test::garment_of(two), x, {});
    CHECK(s.warp.max == Approx(0.1));
    CHECK(s.warp.p99 == Approx(0).margin(1e-12));
    CHECK(s.warp.mean == Approx(0.1 * 0.005 / 1.005));
    x[3] = Vec3(0, -0.0045, 0);
    CHECK(measure_strain(test::garment_of(two), x, {}).compressed_area == Approx(0.005 / 1.005));
}

TEST_CASE("gathers at an eased seam are not strain, but stretch there is") {
    Garment garment = test::garment_of(sheet);
    garment.eased_triangle.assign(garment.triangles.size(), true);
    const Points x = mapped([](const Vec2& p) { return Vec3(0.5 * p[0], 1.02 * p[1], 0); });
    const StrainMeasure s = measure_strain(garment, x, {});
    CHECK(s.weft.min == 0);
    CHECK(s.weft.p99 == 0);
    CHECK(s.warp.max == Approx(0.02));
    CHECK(s.compressed_area == 0);
}

TEST_CASE("limits are the tightest of the fabrics, fabrics without one do not count") {
    Fabric woven, knit, none;
    woven.limit_warp = 0.01, woven.limit_weft = 0.02, woven.limit_shear = 0.3;
    knit.limit_warp = 0.4, knit.limit_weft = 0.01;
    const Garment garment = test::garment_of(sheet);
    const StrainMeasure s = measure_strain(garment, test::flat_points(sheet), {knit, none, woven});
    CHECK(s.limit_warp == 0.01);
    CHECK(s.limit_weft == 0.01);
    CHECK(s.limit_shear == 0.3);
    CHECK(measure_strain(garment, test::flat_points(sheet), {none}).limit_warp == 0);
}

TEST_CASE("angle defects: none on a tube, those of its corners on a pyramid, none at seams") {
    const Tube tube = tube_garment(0.2, 0, 0.5, 24, 10);
    CHECK(measure_developability(tube.garment, tube.x).angle_defect_max < 1e-12);

    // A square pyramid of height 1 over half diagonals of 1: four equilateral triangles of side sqrt(2) at
    // its top.
    const test::FlatMesh star = {{{0, 0}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}},
                                 {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}}};
    Garment pyramid = test::garment_of(star);
    Points x = test::flat_points(star);
    x[0][2] = 1;
    const DevelopabilityMeasure d = measure_developability(pyramid, x);
    CHECK(d.angle_defect_max == Approx(2 * EIGEN_PI - 4 * EIGEN_PI / 3));
    CHECK(d.angle_defect_mean == d.angle_defect_max);
    pyramid.seam_edge[pyramid.edges.of_triangle[0][2]] = true; // an edge at the top
    CHECK(measure_developability(pyramid, x).angle_defect_max == 0);
}

TEST_CASE("ease is the difference of girths by tape measure") {
    const TriMesh body = test::ellipsoid({0.2, 0.8, 0.2}, 200, 200);
    const Tube skirt = tube_garment(0.22, -0.3, 0.4, 100, 9);
    const EaseMeasure e = measure_ease(skirt.garment, skirt.x, body, 0.0);
    CHECK(e.found);
    CHECK(e.body == Approx(2 * EIGEN_PI * 0.2).epsilon(1e-3));
    CHECK(e.garment == Approx(2 * EIGEN_PI * 0.22).epsilon(1e-3));
    CHECK(e.ease == Approx(2 * EIGEN_PI * 0.02).epsilon(1e-2));
    // Higher up the ellipsoid is thinner: at half its height by sqrt(3)/2. The skirt ends at 0.1.
    CHECK_FALSE(measure_ease(skirt.garment, skirt.x, body, 0.4).found);
    const Tube top = tube_garment(0.22, 0.3, 0.4, 100, 9);
    CHECK(measure_ease(top.garment, top.x, body, 0.4).body ==
          Approx(2 * EIGEN_PI * 0.2 * std::sqrt(0.75)).epsilon(1e-3));
    CHECK(measure_ease(top.garment, top.x, body, 0.4).found);
    CHECK_FALSE(measure_ease(top.garment, top.x, body, 2.0).found);
}

TEST_CASE("an open front and a tube around an arm do not go round the torso") {
    const TriMesh body = test::ellipsoid({0.2, 0.8, 0.2}, 60, 60);
    const Tube open = tube_garment(0.22, -0.3, 0.4, 100, 9, 0.1 * EIGEN_PI);
    CHECK_FALSE(measure_ease(open.garment, open.x, body, 0.0).found);
    Tube sleeve = tube_garment(0.06, -0.3, 0.4, 40, 9);
    for (Vec3& p : sleeve.x)
        p[0] += 0.4;
    CHECK_FALSE(measure_ease(sleeve.garment, sleeve.x, body, 0.0).found);
}

TEST_CASE("the torso is told from the arms") {
    TriMesh body = test::ellipsoid({0.2, 0.8, 0.15}, 60, 60),
            arm = test::ellipsoid({0.05, 0.4, 0.05}, 30, 30);
    const int shift = int(body.points.size());
    for (const Vec3& p : arm.points)
        body.points.push_back(p + Vec3(0.4, 0, 0));
    for (const Triangle& t : arm.triangles)
        body.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    const Tube skirt = tube_garment(0.22, -0.3, 0.4, 100, 9);
    // Ramanujan's perimeter of an ellipse with half axes 0.2 and 0.15.
    const double a = 0.2, b = 0.15;
    const double perimeter = EIGEN_PI * (3 * (a + b) - std::sqrt((3 * a + b) * (a + 3 * b)));
    CHECK(measure_ease(skirt.garment, skirt.x, body, 0.0).body == Approx(perimeter).epsilon(2e-3));
}

TEST_CASE("the longest stitch is the seam's gap") {
    Garment garment = test::garment_of(sheet);
    const Points x = test::flat_points(sheet);
    CHECK(seam_gap_max(garment, x) == 0);
    garment.stitches.push_back({0, {1, 1}, 0, 0, 0.01});
    garment.stitches.push_back({0, {2, 5}, 0.25, 0, 0.01});
    const double first = (x[0] - x[1]).norm(), second = (x[0] - 0.75 * x[2] - 0.25 * x[5]).norm();
    CHECK(seam_gap_max(garment, x) == Approx(std::max(first, second)));
}

TEST_CASE("intersections are counted with the body and with itself") {
    const TriMesh body = test::box({-1, -1, -1}, {1, 1, 1});
    const TriMesh sheet_above = test::grid(10, 10, 0.1, 1.01);
    IntersectionCount n = count_intersections(sheet_above.triangles, sheet_above.points, body);
    CHECK(n.cloth_avatar == 0);
    CHECK(n.cloth_cloth == 0);
    TriMesh through =
        test::grid(1, 1, 0.5, 0.5); // from the middle through the corner (0, 0, .5)..(.5, .5, .5): inside
    CHECK(count_intersections(through.triangles, through.points, body).cloth_avatar == 0);
    for (Vec3& p : through.points)
        p[0] += 0.75; // now it pierces the face x = 1
    CHECK(count_intersections(through.triangles, through.points, body).cloth_avatar > 0);
    TriMesh crossed = sheet_above;
    crossed.points[60][2] -= 0.05;
    crossed.points.insert(crossed.points.end(), {{0.2, 0.2, 1.0}, {0.3, 0.2, 1.0}, {0.2, 0.2, 1.03}});
    const int k = int(crossed.points.size());
    crossed.triangles.push_back({k - 3, k - 2, k - 1});
    CHECK(count_intersections(crossed.triangles, crossed.points, {}).cloth_cloth > 0);
}

namespace {

double slow_clearance(const TriMesh& a, const TriMesh& b) {
    double squared = std::numeric_limits<double>::infinity();
    for (const Triangle& s : a.triangles)
        for (const Triangle& t : b.triangles)
            for (int i = 0; i < 3; ++i) {
                const auto &p = a.points, &q = b.points;
                squared =
                    std::min(squared, nearest_point_triangle(p[s[i]], q[t[0]], q[t[1]], q[t[2]]).squared);
                squared =
                    std::min(squared, nearest_point_triangle(q[t[i]], p[s[0]], p[s[1]], p[s[2]]).squared);
                for (int j = 0; j < 3; ++j)
                    squared = std::min(
                        squared,
                        nearest_edge_edge(p[s[i]], p[s[(i + 1) % 3]], q[t[j]], q[t[(j + 1) % 3]]).squared);
            }
    return std::sqrt(squared);
}

} // namespace

TEST_CASE("clearance is that of comparing every corner, side and face") {
    test::Random random(11);
    for (int round = 0; round < 12; ++round) {
        TriMesh body = test::ellipsoid({0.2, 0.3, 0.25}, 12, 9), cloth = test::tube(0.4, 0.3, 11, 5, 0.02);
        const Eigen::AngleAxisd turn(random.in(0, 3), random.vec3().normalized());
        const Vec3 shift = 0.3 * random.vec3();
        for (Vec3& p : cloth.points)
            p = turn * p + shift;
        const double fast = clearance_min(cloth.triangles, cloth.points, body);
        if (count_intersections(cloth.triangles, cloth.points, body).cloth_avatar > 0)
            CHECK(fast == 0);
        else
            CHECK(fast == Approx(slow_clearance(cloth, body)).epsilon(1e-12));
    }
    // Edge over edge: two roofs whose ridges cross a millimetre apart.
    const TriMesh roof = {{{-1, 0, 0}, {1, 0, 0}, {0, 1, -1}, {0, -1, -1}}, {{0, 1, 2}, {1, 0, 3}}};
    const TriMesh other = {{{0, -1, 1e-3}, {0, 1, 1e-3}, {1, 0, 1}, {-1, 0, 1}}, {{0, 1, 2}, {1, 0, 3}}};
    CHECK(clearance_min(roof.triangles, roof.points, other) == Approx(1e-3));
    CHECK(clearance_min(roof.triangles, roof.points, {}) == std::numeric_limits<double>::infinity());
}

TEST_CASE("what is missing round a sleeve is measured round it, however the arm is held") {
    const double radius = 0.05, stretch = 1.1;
    const Tube tube = tube_garment(radius, 0, 0.2, 40, 20);
    Fabric fabric = fabric_preset("poplin");
    fabric.limit_weft = 0.03;
    for (const double degrees : {0.0, 45.0, 90.0}) {
        const Eigen::AngleAxisd raised(degrees * EIGEN_PI / 180, Vec3::UnitZ());
        Points x = tube.x;
        for (Vec3& p : x) p = raised * Vec3(stretch * p.x(), p.y(), stretch * p.z());
        const Tightness t = find_tightness(tube.garment, x, {fabric});
        CHECK(t.strain == Approx(stretch - 1).margin(2e-3));
        CHECK_FALSE(t.warp);
        CHECK(t.missing == Approx(2 * EIGEN_PI * radius * (stretch - 1.03)).margin(1e-3));
    }
}

TEST_CASE("shear, which makes cloth longer aslant, is not missing") {
    // A tube that is twisted: sections along the most stretch wind round it.
    const double radius = 0.05, stretch = 1.031;
    const Tube tube = tube_garment(radius, 0, 0.2, 40, 20);
    Fabric fabric = fabric_preset("poplin");
    fabric.limit_weft = fabric.limit_warp = 0.03;
    Points x = tube.x;
    for (Vec3& p : x) p = Eigen::AngleAxisd(5 * p.y(), Vec3::UnitY()) * Vec3(stretch * p.x(), p.y(), stretch * p.z());
    const Tightness t = find_tightness(tube.garment, x, {fabric});
    CHECK(t.missing > 0);
    CHECK(t.missing < 2 * EIGEN_PI * radius * 0.005);
}

TEST_CASE("what is missing round a waist is that of the section that goes all round, though the worst triangle is at the edge") {
    // Stretched by a tenth, and along half of its slanting upper edge by more.
    const double radius = 0.1;
    const Tube tube = tube_garment(radius, 0, 0.2, 60, 20);
    Fabric fabric = fabric_preset("poplin");
    fabric.limit_weft = 0.03;
    Points x = tube.x;
    for (Vec3& p : x) {
        const double more = p.y() > 0.195 && p.x() > 0 ? 0.01 : 0;
        p = Vec3((1.1 + more) * p.x(), p.y() + 0.3 * p.x() * p.y() / 0.2, (1.1 + more) * p.z());
    }
    const Tightness t = find_tightness(tube.garment, x, {fabric});
    CHECK(t.missing > 2 * EIGEN_PI * radius * 0.06);
}
