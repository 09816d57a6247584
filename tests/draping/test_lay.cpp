// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/lay.h"

#include "draping/pieces.h"
#include "tests/support/random.h"
#include "tests/support/sewn_squares.h"
#include "tests/support/shapes.h"

#include <Eigen/Geometry>

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

namespace {

const TriMesh body = box({-0.1, -0.3, -0.06}, {0.1, 0.3, 0.06});

/// A front and a back round a body, sewn to each other at both sides, and a square sewn below each.
Cloth tabard() {
    Cloth c;
    add_front(c, {0, 0.1, 0.1});
    add_back(c, {0, 0.1, -0.1});
    add_front(c, {0, -0.12, 0.1});
    add_back(c, {0, -0.12, -0.1});
    sew_sides(c, 0, 1);
    sew_sides(c, 2, 3);
    sew_below(c, 0, 2);
    sew_below(c, 1, 3);
    return c;
}

void put(Cloth& c, int panel, const Mat3& turn, const Vec3& shift) {
    const Piece piece = pieces_of(c.garment, c.x)[panel];
    for (int i : piece.nodes) c.x[i] = turn * (c.x[i] - piece.middle) + piece.middle + shift;
}

Vec3 middle(const Cloth& c, const Points& x, int panel) { return pieces_of(c.garment, x)[panel].middle; }

} // namespace

TEST_CASE("panels before and behind a body stay where they are, near as their seams are through it") {
    const Cloth c = tabard();
    const Laid laid = lay_anew(c.garment, c.x, body);
    CHECK(laid.moved.empty());
    CHECK(laid.x == c.x);
}

TEST_CASE("panels much larger than the body are not drawn through it to what they are sewn to") {
    Cloth c;
    add_front(c, {0, 0, 0.1});
    add_back(c, {0, 0, -0.1});
    sew_sides(c, 0, 1);
    const TriMesh slight = box({-0.015, -0.04, -0.06}, {0.015, 0.04, 0.06});
    CHECK(lay_anew(c.garment, c.x, slight).moved.empty());
}

TEST_CASE("a panel in the place of another, its right side to the body, goes through it to its own side") {
    Cloth c = tabard();
    put(c, 3, Mat3::Identity(), middle(c, c.x, 0) - middle(c, c.x, 3));
    const Laid laid = lay_anew(c.garment, c.x, body);
    REQUIRE(laid.moved.size() == 1);
    CHECK(laid.moved[0].panel == 3);
    CHECK(laid.moved[0].moved > 0.2);
    const Vec3 at = middle(c, laid.x, 3);
    CHECK(at.z() < -0.06);
    CHECK(std::abs(at.x()) < 0.01);
    CHECK(std::abs(at.y() + 0.12) < 0.05);
}

TEST_CASE("a panel that lies in the body stays for place_clear() to push out") {
    Cloth c = tabard();
    put(c, 0, Mat3::Identity(), {0, 0, -0.08});
    CHECK(lay_anew(c.garment, c.x, body).moved.empty());
}

TEST_CASE("a panel far off goes to what it is sewn to") {
    Cloth c = tabard();
    put(c, 2, Mat3::Identity(), {0.5, 0.1, 0.05});
    const Laid shifted = lay_anew(c.garment, c.x, body);
    REQUIRE(shifted.moved.size() == 1);
    CHECK(shifted.moved[0].turned == 0);
    CHECK((middle(c, shifted.x, 2) - Vec3(0, -0.12, 0.1)).norm() < 0.05);
}

TEST_CASE("a panel is turned where its threads get much shorter by it") {
    Cloth c;
    add_front(c, {0, 0.1, 0.1});
    add_front(c, {0, -0.12, 0.1});
    sew_below(c, 0, 1);
    for (Vec3& p : c.x) p *= 3;
    put(c, 1, Eigen::AngleAxisd(EIGEN_PI / 2, Vec3::UnitZ()).toRotationMatrix(), {0.2, 0, 0});
    LayOptions o;
    o.fixed = {true, false};
    const Laid laid = lay_anew(c.garment, c.x, body, o);
    REQUIRE(laid.moved.size() == 1);
    CHECK(laid.moved[0].turned == Approx(EIGEN_PI / 2).margin(0.1));
    CHECK((middle(c, laid.x, 1) - middle(c, laid.x, 0) - Vec3(0, -0.6, 0)).norm() < 0.05);
}

TEST_CASE("a panel that is laid anew stays rigid") {
    Random random(3);
    Cloth c = tabard();
    put(c, 1, Eigen::AngleAxisd(2, random.vec3().normalized()).toRotationMatrix(), 0.8 * random.vec3());
    const Laid laid = lay_anew(c.garment, c.x, body);
    REQUIRE(!laid.moved.empty());
    const std::vector<Piece> pieces = pieces_of(c.garment, c.x);
    for (const Piece& piece : pieces)
        for (int i : piece.nodes)
            CHECK((laid.x[i] - laid.x[piece.nodes[0]]).norm() ==
                  Approx((c.x[i] - c.x[piece.nodes[0]]).norm()).margin(1e-12));
}

TEST_CASE("panels that must stay do, and so does everything when right sides mostly look at the body") {
    Cloth c = tabard();
    put(c, 2, Mat3::Identity(), {0.5, 0.1, 0.05});
    LayOptions o;
    o.fixed = {false, false, true, false};
    for (const LaidPanel& p : lay_anew(c.garment, c.x, body, o).moved) CHECK(p.panel != 2);
    for (Triangle& t : c.garment.triangles) std::swap(t[0], t[1]);
    CHECK(lay_anew(c.garment, c.x, body).moved.empty());
}
