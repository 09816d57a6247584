// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/cloth_friction.h"

#include "tests/support/random.h"

#include <catch2/catch.hpp>

#include <Eigen/Geometry>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double gap = 4e-4; // m

/// A node over a triangle, and an edge over another.
Points layers() {
    return {{0, 0, 0},      {0.02, 0, 0},     {0, 0, 0.02},         {0.005, gap, 0.006},
            {-0.01, 0, 0.05}, {0.01, 0, 0.05}, {0.001, gap, 0.04}, {0, gap, 0.06}};
}

std::vector<PairForce> pressed(double newton = 1e-3) {
    PairForce node{{3, 0, 1, 2}, {1, -0.45, -0.25, -0.3}, false, newton * Vec3::UnitY()};
    PairForce edges{{6, 7, 4, 5}, {0.5, 0.5, -0.475, -0.525}, true, newton * Vec3::UnitY()};
    return {node, edges};
}

Friction tied(const Points& x) {
    Friction f;
    f.coefficient = 0.4;
    match_ties(f, pressed(), x, x);
    for (Tie& tie : f.ties) tie.force = 1e-3;
    return f;
}

Points slid_by(Points x, const Vec3& by) {
    for (int i : {3, 6, 7}) x[i] += by;
    return x;
}

} // namespace

TEST_CASE("friction of cloth on cloth takes from one what it gives to the other") {
    const Points x = layers(), gone = slid_by(x, Vec3(6e-5, 0, -3e-5));
    const Friction f = tied(x);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(3 * x.size());
    add_gradient(f, gone, g);
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (int i = 0; i < int(x.size()); ++i) {
        force += g.segment<3>(3 * i);
        torque += gone[i].cross(Vec3(g.segment<3>(3 * i)));
    }
    const double one = friction_force(f, gone, 0).norm(), both = one + friction_force(f, gone, 1).norm();
    CHECK(one > 0.1 * hardest(f, f.ties[0]));
    CHECK(force.norm() < 1e-12 * both);
    CHECK(torque.norm() < 1.3 * gap * both); // of forces that are the gap apart, and what has been slid
}

TEST_CASE("layers of cloth that turn as a whole keep the friction between them") {
    const Points x = layers(), gone = slid_by(x, Vec3(6e-5, 0, -3e-5));
    Friction f = tied(x);
    const Vec3 start[] = {friction_force(f, gone, 0), friction_force(f, gone, 1)};
    Points last = gone;
    Mat3 turn = Mat3::Identity();
    for (int step = 0; step < 10; ++step) {
        turn = Eigen::AngleAxisd(0.2, Vec3(1, 2, -3).normalized()).toRotationMatrix() * turn;
        Points now;
        for (const Vec3& p : gone) now.push_back(turn * p + Vec3(0.1, 0.2, 0.3));
        std::vector<PairForce> forces = pressed();
        for (PairForce& p : forces) p.force = turn * p.force;
        match_ties(f, forces, last, now);
        last = now;
        for (int t : {0, 1}) CHECK((friction_force(f, now, t) - turn * start[t]).norm() < 1e-9 * start[t].norm());
    }
}

TEST_CASE("ties come and go with what touches") {
    const Points x = layers(), gone = slid_by(x, Vec3(6e-5, 0, 0));
    Friction f = tied(x);
    const double before = friction_force(f, gone, 1).norm();
    match_ties(f, {pressed()[1]}, x, gone);
    REQUIRE(f.ties.size() == 1);
    CHECK(friction_force(f, gone, 0).norm() == Approx(before));
    match_ties(f, pressed(), gone, gone);
    REQUIRE(f.ties.size() == 2);
    f.ties[0].force = 1e-3;
    CHECK(friction_force(f, gone, 0).norm() == 0); // tied anew, where it is
    CHECK(friction_force(f, gone, 1).norm() == Approx(before));
}

TEST_CASE("what has slid far is anchored where it has come to, and held by as much") {
    const Points x = layers(), gone = slid_by(x, Vec3(2e-3, 0, 0));
    Friction f = tied(x);
    const double before = friction_force(f, gone, 0).norm();
    std::vector<PairForce> forces = pressed();
    forces[0].weight = {1, -0.35, -0.35, -0.3};
    match_ties(f, forces, x, gone);
    CHECK(f.ties[0].weight == forces[0].weight);
    CHECK(friction_force(f, gone, 0).norm() == Approx(before));
    CHECK(friction_force(f, slid_by(gone, Vec3(-4e-4, 0, 0)), 0).x() > 0); // it opposes the way back
}

TEST_CASE("friction is taken up from the forces that it held") {
    // A stack of three nodes on a body, each tied to the one below; they pull in all directions, within the limits.
    const Points x{{0, gap, 0}, {0, 2 * gap, 0}, {0, 3 * gap, 0}};
    Friction body = friction_at(x, 0.5), cloth;
    body.ties[0].force = 3;
    cloth.coefficient = 0.3;
    for (int i : {0, 1}) {
        Tie& tie = cloth.ties.emplace_back();
        tie.point = {i + 1, i, i, i};
        tie.weight = {1, -1, 0, 0};
        tie.force = 2.0 - i;
    }
    const std::vector<char> pinned(3, 0);
    Eigen::VectorXd g(9);
    g << 0.3, 0, 0.2, -0.5, 0, 0.1, 0.2, 0, -0.15;
    Eigen::VectorXd left = g;
    take_up(body, cloth, x, pinned, left);
    CHECK(left.norm() < 1e-6);
    Eigen::VectorXd friction = Eigen::VectorXd::Zero(9);
    add_gradient(body, x, friction);
    add_gradient(cloth, x, friction);
    CHECK((friction + g).norm() < 1e-6);

    // More than they can bear is left over, and what is pinned needs nothing.
    g << 0, 0, 0, 0, 0, 0, 1, 0, 0;
    left = g;
    take_up(body, cloth, x, pinned, left);
    CHECK(left.norm() > 0.3);
    CHECK(friction_force(cloth, x, 1).norm() == Approx(hardest(cloth, cloth.ties[1])));
    left = g;
    take_up(body, cloth, x, {0, 0, 1}, left);
    CHECK(friction_force(cloth, x, 1).norm() < 1e-9);
}
