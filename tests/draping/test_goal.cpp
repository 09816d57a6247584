// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/fit/goal.h"
#include "tests/support/skirt.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

namespace {

/// A tube of 16 cm radius from 1 m down to 0.5 m, shaken by millimetres.
Skirt shaken_skirt() {
    Skirt s = make_skirt(12, 8, 0.16, 1.0, 0.5);
    for (std::size_t i = 0; i < s.x.size(); ++i)
        s.x[i] += 2e-3 * Vec3(std::sin(7.0 * double(i)), std::sin(3.0 * double(i)), std::cos(5.0 * double(i)));
    return s;
}

std::vector<FitGoal> one_of_each(const Skirt& s) {
    Points target = s.x;
    for (Vec3& p : target) p *= 1.02;
    std::vector<int> hem;
    for (int v = 0; v <= 12; ++v) hem.push_back(v); // the lowest row of the front
    StrainGoal strain;
    for (int t = 0; t < int(s.garment.triangles.size()); ++t) strain.triangles.push_back(t);
    const Skirt wider = make_skirt(9, 5, 0.163, 1.0, 0.47);
    return {{"shape", shape_goal(s.garment, target), 5e-3},
            {"surface", surface_goal(s.garment, {wider.x, node_triangles(wider.garment)}), 5e-3},
            {"hem", level_goal(s.garment, {hem}, 0.52), 2e-3},
            {"hem, level", level_goal(s.garment, {hem}, {}), 2e-3},
            {"girth", GirthGoal{0.77, 1.1, {0, 1}}, 5e-3},
            {"strain", strain, 0.01}};
}

} // namespace

TEST_CASE("the gradient of every goal is that of its value") {
    const Skirt s = shaken_skirt();
    for (const FitGoal& goal : one_of_each(s)) {
        INFO(goal.name);
        const std::vector<FitGoal> goals{goal};
        Eigen::VectorXd g = Eigen::VectorXd::Zero(3 * Eigen::Index(s.x.size()));
        add_gradient(goals, s.garment, s.x, g);
        REQUIRE(g.norm() > 0);
        Eigen::VectorXd difference(g.size());
        constexpr double h = 1e-7;
        for (Eigen::Index i = 0; i < g.size(); ++i) {
            Points low = s.x, high = s.x;
            flat(low)[i] -= h;
            flat(high)[i] += h;
            difference[i] = (value(goals, s.garment, high) - value(goals, s.garment, low)) / (2 * h);
        }
        CHECK((difference - g).norm() < 1e-6 * g.norm());
    }
}

TEST_CASE("a miss is what a tape or a ruler says") {
    const Skirt s = make_skirt(48, 8, 0.16, 1.0, 0.5);
    const std::vector<FitGoal> goals = one_of_each(s);
    CHECK(miss(goals[2], s.garment, s.x) == Approx(0.02)); // asked for 0.52 m, is at 0.5 m
    CHECK(value({goals[2]}, s.garment, s.x) == Approx(100));
    CHECK(miss(goals[3], s.garment, s.x) < 1e-12);
    CHECK(miss(goals[4], s.garment, s.x) == Approx(1.1 - 2 * EIGEN_PI * 0.16).epsilon(2e-3));
    const Points same = s.x;
    CHECK(miss({"shape", shape_goal(s.garment, same), 1e-3}, s.garment, s.x) == 0);
    CHECK(std::isinf(miss({"girth", GirthGoal{2, 1, {0, 1}}, 5e-3}, s.garment, s.x)));
}

TEST_CASE("a surface of other triangles is missed by how far cloth and surface are apart, whichever ends first") {
    const Skirt s = make_skirt(48, 24, 0.16, 1.0, 0.5);
    const auto missed = [&](const Skirt& other) {
        return miss({"surface", surface_goal(s.garment, {other.x, node_triangles(other.garment)}), 1e-3}, s.garment, s.x);
    };
    CHECK(missed(make_skirt(31, 17, 0.16, 1.0, 0.5)) < 1e-3); // chords of two circles
    CHECK(missed(make_skirt(48, 24, 0.17, 1.0, 0.5)) == Approx(0.01).epsilon(0.01));
    // 5 cm too long, either way: the tenth of the longer that the shorter has not got is 0 to 5 cm off, half of all.
    const double off = 0.05 * std::sqrt(0.5 / 3 * 0.1);
    CHECK(missed(make_skirt(48, 240, 0.16, 1.0, 0.5 / 0.9)) == Approx(0.5 / 0.9 * 0.1 * std::sqrt(0.5 / 3 * 0.1)).epsilon(0.02));
    CHECK(missed(make_skirt(48, 240, 0.16, 1.0, 0.45)) == Approx(off).epsilon(0.05));
}
