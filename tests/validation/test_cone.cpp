// SPDX-License-Identifier: GPL-3.0-or-later
// A disc with a sector cut out and its cut sewn up is a cone: a circle of radius r keeps its length (2 pi -
// deficit) r, so that the half angle has sine 1 - deficit / 2 pi. Its curvature is cos / (r sin) across the
// generators, so that bending holds pi D cos cot log(outer / inner) in all.

#include "draping/cloth.h"
#include "draping/solve/settle.h"

#include "tests/support/flat_mesh.h"
#include "tests/support/plain_fabric.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double inner = 0.05, outer = 0.2; // m, the tip is cut off: no sheet of paper has one

Fabric paper() {
    Fabric f = plain_fabric(2000, 1e-5);
    f.shear = 1000;
    f.compression = 1;
    return f;
}

struct Sector {
    Garment garment;         ///< sewn
    std::vector<Vec2> polar; ///< per node: angle in the flat sector, logarithm of radius / inner
};

// (angle, log radius) to the plane keeps angles, so that the triangles stay well shaped.
Sector sewn_sector(double angle, std::uint64_t seed) {
    const double height = std::log(outer / inner);
    const FlatMesh strip = jittered_rectangle(angle, height, 0.08, 0.25, seed);
    FlatMesh flat = strip;
    for (Vec2& p : flat.points)
        p = inner * std::exp(p.y()) * Vec2(std::cos(p.x()), std::sin(p.x()));
    Garment open = garment_of(flat);
    for (int a = 0; a < open.node_count; ++a)
        for (int b = 0; b < open.node_count; ++b)
            if (strip.points[a].x() < 1e-9 && strip.points[b].x() > angle - 1e-9 &&
                std::abs(strip.points[a].y() - strip.points[b].y()) < 1e-9)
                open.stitches.push_back({b, {a, a}, 0, 0, 0.01});
    std::vector<int> node;
    Sector s{close_seams(open, &node), {}};
    s.polar.resize(s.garment.node_count);
    for (int i = open.node_count - 1; i >= 0; --i)
        s.polar[node[i]] = strip.points[i];
    return s;
}

// Angles to the axis, degrees, of the straight lines from the inner rim to the outer one.
std::vector<double> generator_angles(const Sector& s, const Points& x) {
    std::vector<std::pair<double, int>> rim[2];
    Vec3 centre[2] = {Vec3::Zero(), Vec3::Zero()};
    for (int i = 0; i < int(x.size()); ++i)
        for (int k = 0; k < 2; ++k)
            if (std::abs(s.polar[i].y() - k * std::log(outer / inner)) < 1e-9) {
                rim[k].emplace_back(s.polar[i].x(), i);
                centre[k] += x[i];
            }
    REQUIRE(rim[0].size() == rim[1].size());
    const Vec3 axis = (centre[1] - centre[0]).normalized();
    for (auto& r : rim)
        std::sort(r.begin(), r.end());
    std::vector<double> angles;
    for (std::size_t k = 0; k < rim[0].size(); ++k) {
        const Vec3 along = (x[rim[1][k].second] - x[rim[0][k].second]).normalized();
        angles.push_back(std::acos(along.dot(axis)) * 180 / pi);
    }
    return angles;
}

} // namespace

TEST_CASE("a sewn sector of a disc is a cone", "[validation]") {
    for (const auto& [deficit, half_angle, energy] :
         {std::array{30.0, 66.44353569, 0.54739872}, {90, 48.59037789, 1.83259571}, {180, 30, 4.71238898}}) {
        const double angle = (360 - deficit) * pi / 180;
        const Sector s = sewn_sector(angle, 3);
        const Barrier unused{0.5e-3, 0.5e-4, 1e6};
        ClothProblem problem(s.garment, {paper()}, {}, {unused, unused, false});
        // A start of the wrong angle, with rings too long or too short, and rough.
        const double start = (half_angle + 4) * pi / 180;
        Random random(9);
        Points x;
        for (const Vec2& p : s.polar) {
            const double round = 2 * pi * p.x() / angle, slant = inner * std::exp(p.y());
            x.push_back(slant * Vec3(std::sin(start) * std::cos(round), -std::cos(start),
                                     std::sin(start) * std::sin(round)) +
                        random.vec3(5e-4));
        }
        SettleOptions options;
        options.tolerance = 1e-5;
        Cholesky factor;
        REQUIRE(settle(problem, x, factor, options).end == SettleEnd::settled);
        INFO("deficit " << deficit);
        for (double a : generator_angles(s, x))
            CHECK(a == Approx(half_angle).margin(0.5));
        CHECK(bend_value(problem.sheet().bending, x) ==
              Approx(1e-5 * energy * std::log(outer / inner)).epsilon(0.03));
    }
}
