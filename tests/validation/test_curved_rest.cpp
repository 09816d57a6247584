// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth whose rest shape is curved, and shells with known answers.

#include "draping/energy/springs.h"

#include "tests/support/curved_shells.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>

#include <Eigen/Geometry>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double pi = std::numbers::pi;

double most_curvature_energy(const Sheet& sheet) {
    double most = 0;
    for (const RestCurvature& c : sheet.curved) most += c.most;
    return most;
}

} // namespace

TEST_CASE("a patch of a sphere and a whole one are at rest, wherever they are, and return to it", "[validation]") {
    const auto dome = [](const Vec2& p) -> Vec3 {
        const double r = p.norm(), angle = pi / 3 * r;
        return r > 0 ? Vec3(std::sin(angle) * p.x() / r, std::sin(angle) * p.y() / r, std::cos(angle)) : Vec3(0, 0, 1);
    };
    for (const Cloth& c : {pressed(disc(7, 0.25, 1), dome, 0.3), moulded_mesh(ellipsoid(Vec3(1, 1, 1), 18, 10))}) {
        const Fabric fabric = isotropic(1, 1e-3);
        FreeCloth cloth = free_cloth(c.garment, fabric);
        const Sheet sheet = make_sheet(c.garment, {fabric});
        const double most = most_curvature_energy(sheet);
        CHECK(most > 1e-4);
        Eigen::VectorXd force, other;
        const Mat3 turn = Eigen::AngleAxisd(2.2, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
        for (const Mat3& by : {Mat3(Mat3::Identity()), turn}) {
            Points x = c.x, bent(x.size(), Vec3::Zero());
            for (Vec3& p : x) p = by * p + Vec3(0.3, -1, 0.2);
            cloth.gradient(x, force);
            bend_gradient(sheet.bending, x, bent);
            CHECK(std::abs(cloth.value(x)) < 1e-10 * most);
            CHECK(force.norm() < 1e-10 * flat(bent).norm());
        }
        Random random(2);
        Points x = c.x;
        for (Vec3& p : x) p += random.vec3(0.02);
        CHECK(cloth.value(x) > 0.01 * most);
        REQUIRE(comes_to_rest(cloth, x, 1e-8));
        CHECK(cloth.value(x) < 1e-8 * most);
        for (const auto& [a, b] : c.garment.edges.ends)
            CHECK((x[a] - x[b]).norm() == Approx((c.x[a] - c.x[b]).norm()).epsilon(1e-4));
    }
}

TEST_CASE("a shallow cap stays inside out from the slenderness on that shell theory says", "[validation]") {
    const Threshold found = bistable_from(10, 0.01);
    REQUIRE(found.settled);
    CHECK(found.lambda == Approx(5.087275721655189).epsilon(0.01));
}

TEST_CASE("a corrugated sheet is stiff along its ridges and soft across, as its section says", "[validation]") {
    const Stiffness along = stiffness_along(corrugated(20, 40)), across = stiffness_across(corrugated(20, 10));
    REQUIRE(along.settled);
    REQUIRE(across.settled);
    CHECK(along.ratio == Approx(157.99410512854251).epsilon(0.02));
    CHECK(across.ratio == Approx(0.9154293859909557).epsilon(0.02));
}

TEST_CASE("two springs snap through where a von Mises truss does", "[validation]") {
    const double half_span = 1, stiffness_times_length = 1; // EA
    for (const auto& [rise, most, at] :
         {std::array{0.05, 4.799252445726753e-05, 0.028855495}, {0.1, 3.8108719041809997e-4, 0.057639255},
          {0.2, 2.960517600763096e-3, 0.114714448}, {0.5, 3.838373981743475e-2, 0.277880091}}) {
        const double length = std::hypot(half_span, rise);
        Spring left{0, 1, length, 0, stiffness_times_length / length}, right{1, 2, length, 0, stiffness_times_length / length};
        const Springs truss({left, right});
        const auto load = [&](double height) { // N downward on the middle
            Eigen::VectorXd g = Eigen::VectorXd::Zero(9);
            truss.add_gradient({{-half_span, 0, 0}, {0, height, 0}, {half_span, 0, 0}}, g);
            return -g[4];
        };
        double limit = 0, where = 0;
        for (int i = 0; i <= 20000; ++i) {
            const double height = rise * i / 20000;
            if (load(height) > limit) limit = load(height), where = height;
        }
        CHECK(limit == Approx(most).epsilon(1e-6));
        CHECK(where == Approx(at).epsilon(1e-3));
        const double h = 0.7 * rise, l = std::hypot(half_span, h);
        CHECK(load(h) == Approx(2 * (length - l) / length * h / l).epsilon(1e-6));
    }
}
