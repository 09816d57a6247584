// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/contact/contact.h"
#include "draping/contact/friction.h"
#include "tests/support/random.h"
#include "tests/support/small_contact.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>

#include <algorithm>

#include <cmath>
#include <numeric>
#include <set>

using namespace toile;
using test::Random;
using test::tetrahedron;
using test::two_sheets;

namespace {

Points near_contact() {
    return {{0.001, 0.0008, 0.002}, {0.021, 0.0011, 0.001}, {0.008, 0.0009, 0.019},
            {0.004, 0.0016, 0.005}, {0.018, 0.0024, -0.004}, {0.002, 0.0019, 0.014}};
}

ContactOptions options() {
    ContactOptions o;
    o.body = {2e-3, 1e-4, 1e5};
    o.cloth = {2e-3, 1e-4, 1e5};
    return o;
}

} // namespace

TEST_CASE("the barrier is smooth where it begins and infinite at its floor") {
    const Barrier b{1e-3, 1e-4, 1e6};
    CHECK(b.energy(1e-3) == 0);
    CHECK(b.slope(1e-3) == 0);
    CHECK(b.curvature(1e-3) == 0);
    CHECK(std::isinf(b.energy(1e-4)));
    for (const double d : {1.5e-4, 3e-4, 7e-4, 9.9e-4}) {
        const double h = 1e-9;
        CHECK((b.energy(d + h) - b.energy(d - h)) / (2 * h) == Approx(b.slope(d)).epsilon(1e-5));
        CHECK((b.slope(d + h) - b.slope(d - h)) / (2 * h) == Approx(b.curvature(d)).epsilon(1e-5));
        CHECK(b.curvature(d) > 0);
    }
}

TEST_CASE("contact: a step that would pass through ends before it") {
    const Points x = near_contact();
    Contact contact(two_sheets(), tetrahedron(), options());
    Eigen::VectorXd down = Eigen::VectorXd::Zero(18);
    for (int i = 0; i < 6; ++i) down[3 * i + 1] = -0.02;
    contact.prepare(x, down);
    int blocking = -1;
    const double t = contact.feasible_step(x, down, nullptr, &blocking);
    CHECK(t > 0);
    CHECK(t < 0.05);
    REQUIRE(blocking >= 0);
    CHECK(contact.pair(blocking).with_body);
    Points moved = x;
    flat(moved) += t * down;
    contact.prepare(moved, Eigen::VectorXd::Zero(18));
    CHECK(contact.violations(moved).empty());

    Eigen::VectorXd up = -down;
    contact.prepare(x, up);
    CHECK(contact.feasible_step(x, up) == 1);
}

TEST_CASE("contact: a body that moves is stopped by the cloth") {
    const Points x = near_contact();
    const TriMesh body = tetrahedron();
    Contact contact(two_sheets(), body, options());
    const Points up(body.points.size(), Vec3(0, 0.05, 0));
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(18);
    contact.prepare(x, still, &up);
    const double t = contact.feasible_step(x, still, &up);
    CHECK(t > 0);
    CHECK(t < 0.02);
}

TEST_CASE("contact: parallel edges are not passed over for a normal made of rounding") {
    test::Random random(3);
    for (int k = 0; k < 200; ++k) {
        const Vec3 along = random.vec3(1).normalized(), across = along.unitOrthogonal(), out = along.cross(across);
        const Vec3 at = Vec3::Zero(); // where coordinates have no rounding of their own
        const Points x = {at, at + 0.02 * along, at - 0.02 * across,
                          at + 0.0015 * out + 0.007 * along, at + 0.0015 * out + 0.021 * along, at + 0.02 * across};
        Contact contact(two_sheets(), {}, options());
        contact.prepare(x, Eigen::VectorXd::Zero(18));
        const auto& active = contact.active(x);
        CHECK(std::any_of(active.begin(), active.end(), [&](const ActivePair& a) {
            return contact.pair(a.pair).p == std::array<int, 4>{0, 1, 3, 4};
        }));
    }
}

TEST_CASE("contact: nodes that a seam will merge do not repel each other") {
    ContactCloth cloth = two_sheets();
    cloth.group = {0, 1, 2, 0, 1, 2};
    Points x = near_contact();
    for (int k = 0; k < 3; ++k) x[3 + k] = x[k] + Vec3(0, 1e-4, 0);
    ContactOptions o = options();
    o.body.distance = 2e-4; // only cloth with cloth
    o.body.floor = 2e-5;
    Contact contact(cloth, tetrahedron(), o);
    contact.prepare(x, Eigen::VectorXd::Zero(18));
    CHECK(contact.active(x).empty());
}

TEST_CASE("contact: a list that is kept up finds the pairs of a new one") {
    test::Random random(5);
    TriMesh upper = test::grid(12, 12, 0.01), body = test::grid(9, 9, 0.014, -0.0015);
    const TriMesh lower = test::grid(12, 12, 0.01, 0.0012);
    const int half = int(upper.points.size());
    for (const Triangle& t : lower.triangles) upper.triangles.push_back({t[0] + half, t[1] + half, t[2] + half});
    Points x = upper.points;
    x.insert(x.end(), lower.points.begin(), lower.points.end());
    ContactCloth cloth;
    cloth.triangles = upper.triangles;
    cloth.edges = make_edges(cloth.triangles, int(x.size())).ends;
    cloth.node_area.assign(x.size(), 1e-4);
    cloth.node_reach.assign(x.size(), 0.007);
    cloth.edge_length.assign(cloth.edges.size(), 0.01);
    cloth.edge_area.assign(cloth.edges.size(), 1e-4);
    cloth.group.resize(x.size());
    std::iota(cloth.group.begin(), cloth.group.end(), 0);

    const auto touching = [](const Contact& contact, const Points& at) {
        std::set<std::array<int, 6>> pairs;
        for (const ActivePair& a : contact.active(at)) {
            const ContactPair p = contact.pair(a.pair);
            pairs.insert({p.p[0], p.p[1], p.p[2], p.p[3], p.edge_edge, p.with_body});
        }
        CHECK(pairs.size() == contact.active(at).size()); // none twice
        return pairs;
    };
    Contact kept(cloth, body, options());
    for (int step = 0; step < 40; ++step) {
        Eigen::VectorXd dx = Eigen::VectorXd::Zero(3 * x.size());
        const int centre = random.below(int(x.size()));
        const double reach = step % 10 == 9 ? 1 : 0.03; // now and then all move
        for (std::size_t i = 0; i < x.size(); ++i)
            if ((x[i] - x[centre]).norm() < reach) dx.segment<3>(3 * i) = random.vec3(0.001);
        kept.prepare(x, dx);
        flat(x) += dx;
        Contact fresh(cloth, body, options());
        fresh.prepare(x, Eigen::VectorXd::Zero(dx.size()));
        const auto expected = touching(fresh, x);
        CHECK(expected.size() > 100);
        CHECK(touching(kept, x) == expected);
    }
}

TEST_CASE("contact: active pairs asked for again are those of the body and the list at hand") {
    const Points x = near_contact();
    const TriMesh body = tetrahedron();
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(18);
    Contact contact(two_sheets(), body, options());
    contact.prepare(x, still);
    const auto distances = [](const Contact& c, const Points& at) {
        std::vector<double> d;
        for (const ActivePair& a : c.active(at)) d.push_back(a.geometry.d);
        return d;
    };
    const std::vector<double> first = distances(contact, x);
    REQUIRE(!first.empty());
    CHECK(distances(contact, x) == first);

    TriMesh lower = body;
    for (Vec3& p : lower.points) p.y() -= 2e-4;
    contact.set_body(lower.points);
    Contact fresh(two_sheets(), lower, options());
    fresh.prepare(x, still);
    const std::vector<double> then = distances(fresh, x);
    CHECK(then != first);
    CHECK(distances(contact, x) == then);

    contact.leave_out(std::vector<char>(6, 1));
    contact.prepare(x, still);
    CHECK(distances(contact, x).size() < then.size());
}

TEST_CASE("contact: pairs that may come within reach are all that do") {
    Random random(5);
    const ContactCloth cloth = two_sheets();
    ContactOptions o;
    o.body = o.cloth = {2e-3, 0, 0};
    int found = 0;
    for (int round = 0; round < 200; ++round) {
        Points x;
        for (int i = 0; i < 6; ++i) x.push_back(Vec3(0.02 * (i % 3 == 1), 0.01, 0.02 * (i % 3 == 2)) + random.vec3(0.01));
        Eigen::VectorXd dx(18);
        for (int i = 0; i < 6; ++i) dx.segment<3>(3 * i) = random.vec3(0.01);
        Contact contact(cloth, tetrahedron(), o);
        contact.prepare(x, dx);
        const std::vector<int> reach = contact.within_reach(x, dx);
        CHECK(std::is_sorted(reach.begin(), reach.end()));
        for (const double t : {0.0, 0.3, 0.7, 1.0}) {
            Points at = x;
            flat(at) += t * dx;
            for (const ActivePair& a : contact.active(at)) {
                CHECK(std::binary_search(reach.begin(), reach.end(), a.pair));
                ++found;
            }
        }
    }
    CHECK(found > 100);
}

TEST_CASE("friction: limit and stick") {
    Friction f = friction_at({{0, 0, 0}, {0.1, 0, 0}, {0, 0, 0.1}}, 0.3);
    f.ties[1].normal = Vec3(0.6, 0.8, 0);
    f.ties[0].force = 1e-3;
    f.ties[1].force = 2e-3;
    const Points x{{0.5e-4, 0.2, 0.3e-4}, {0.1007, 0.01, 0.0003}, {1, 1, 1}};
    CHECK(friction_force(f, x, 0).norm() < 0.3 * 1e-3);
    CHECK(friction_force(f, x, 1).norm() == Approx(0.995 * 0.3 * 2e-3)); // it slides
    CHECK(std::abs(friction_force(f, x, 1).dot(f.ties[1].normal)) < 1e-12);
    CHECK(friction_force(f, x, 2).norm() == 0);
}

TEST_CASE("friction follows a normal force up and down, and less each time") {
    Friction f = friction_at({Vec3::Zero()}, 0.3);
    const Points slid{{1e-3, 0, 0}};
    f.ties[0].force = 1;
    follow(f, slid, 0, 1.1, true);
    CHECK(f.ties[0].force == 1.1); // it slides for want of it
    double share = friction_force(f, slid, 0).norm() / (0.3 * f.ties[0].force);
    CHECK(share == Approx(0.995));
    for (int turn = 0; turn < 6; ++turn) {
        follow(f, slid, 0, 1, true);
        CHECK(f.ties[0].force == 1);
        const double next = friction_force(f, slid, 0).norm() / (0.3 * f.ties[0].force);
        CHECK(next <= share);
        share = next;
        follow(f, slid, 0, 1.1, true);
    }
    CHECK(share == Approx(0.95));
    CHECK(f.ties[0].force == 1); // no longer
    // What hardly moves needs no more than it has.
    const Points near{{1e-5, 0, 0}};
    Friction held = friction_at({Vec3::Zero()}, 0.3);
    held.ties[0].force = 1;
    follow(held, near, 0, 2, true);
    CHECK(held.ties[0].force == 1);
}
