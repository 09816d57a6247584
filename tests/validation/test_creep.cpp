// SPDX-License-Identifier: GPL-3.0-or-later
// What friction holds up stays where it is: settled on, or taken up again from where it rests.

#include "draping/cloth.h"
#include "draping/solve/settle.h"

#include "tests/support/shapes.h"
#include "tests/support/skirt.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

namespace {

double farthest(const Points& a, const Points& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        most = std::max(most, (a[i] - b[i]).norm());
    return most;
}

} // namespace

TEST_CASE("a skirt that friction holds up does not creep", "[validation]") {
    // Cut a tenth too narrow for the ball that it hangs on, held by hooks at its top until it has come to
    // rest.
    const TriMesh ball = sphere(0.1, 5);
    Skirt s = make_skirt(24, 12, 0.1, 0.035, 0.15);
    for (Mat2& e : s.garment.rest.edges)
        e.row(0) /= 1.1;
    ContactOptions contact;
    contact.body = contact.cloth = {0.5e-3, 0.5e-4, 1e7};
    ClothProblem problem(s.garment, {fabric_preset("jersey"), fabric_preset("jersey")}, ball, contact);
    problem.gravity = 9.81;
    for (Vec3& p : s.x)
        p = Vec3(1.01 * p.x(), p.y(), 1.01 * p.z());
    for (int i = 0; i < problem.points(); ++i)
        if (s.x[i].y() > 0.034) problem.hooks.push_back({i, s.x[i], Vec3::UnitY(), 10, 1});
    Cholesky factor;
    SettleOptions options;
    REQUIRE(settle(problem, s.x, factor, options).end == SettleEnd::settled);
    problem.hooks.clear();
    problem.rest_here(s.x, {0.35}, true);
    REQUIRE(settle(problem, s.x, factor, options).end == SettleEnd::settled);
    double held = 0, weight = 0;
    for (int i = 0; i < problem.points(); ++i) {
        held += friction_force(problem.friction, s.x, i).y();
        weight += 9.81 * problem.node_mass()[i];
    }
    CHECK(std::abs(held) > 0.1 * weight); // friction has its part in it

    Points longer = s.x;
    options.tolerance = 1e-7;
    options.max_iterations = 500;
    CHECK(settle(problem, longer, factor, options).end == SettleEnd::settled);
    CHECK(farthest(longer, s.x) < 1e-4);

    Points again = s.x;
    problem.rest_here(again, {0.35}, true);
    options.tolerance = 1e-5;
    CHECK(settle(problem, again, factor, options).end == SettleEnd::settled);
    CHECK(farthest(again, s.x) < 1e-4);
}
