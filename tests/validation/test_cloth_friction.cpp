// SPDX-License-Identifier: GPL-3.0-or-later
// Friction of cloth on cloth, at the angle at which it gives way and where it has to hold: a small sheet on a large one
// on a board that is tilted.

#include "draping/cloth.h"
#include "draping/solve/settle.h"

#include "tests/support/cloth_scene.h"
#include "tests/support/plain_fabric.h"
#include "tests/support/shapes.h"
#include "tests/support/tilted.h"

#include <catch2/catch.hpp>

#include <Eigen/Geometry>

#include <numbers>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double degree = std::numbers::pi / 180;

void lay(Points& x, const FlatMesh& mesh, double width, double height, double turn) {
    const Eigen::Rotation2Dd r(turn);
    for (const Vec2& p : mesh.points) {
        const Vec2 q = r * (p - Vec2(width / 2, width / 2));
        x.push_back({q.x(), height, q.y()});
    }
}

/// Comes to rest on a level board, and is tilted as it is.
struct Layers {
    TriMesh board = box(Vec3(-0.5, -0.1, -0.5), Vec3(0.5, 0, 0.5));
    Garment garment;
    Points x;
    int first = 0; ///< node of the small sheet
    double bend = 0;
    Cholesky factor = {};

    explicit Layers(double bend) : bend(bend) {
        constexpr double small = 0.06, large = 0.14; // m
        FlatMesh all = jittered_rectangle(large, large, 0.011, 0.25, 5);
        const FlatMesh upper = jittered_rectangle(small, small, 0.01, 0.25, 7);
        first = int(all.points.size());
        lay(x, all, large, 0.45e-3, 0);
        lay(x, upper, small, 0.9e-3, 0.2);
        add_sheet(all, upper, 1);
        garment = garment_of(all);
    }

    std::unique_ptr<ClothProblem> problem(const FrictionCoefficients& friction, bool fixed, bool at_rest = false) const {
        auto p = std::make_unique<ClothProblem>(garment, PanelFabrics{plain_fabric(2000, bend)}, board, light_barriers());
        p->gravity = 9.81;
        for (int i = 0; i < first && fixed; ++i) p->pin(i);
        p->rest_here(x, friction, at_rest);
        return p;
    }

    SettleResult settle_to(ClothProblem& p, SettleOptions options) { return settle(p, x, factor, options); }

    void tilt(double angle, bool fixed) {
        SettleOptions options;
        options.tolerance = 1e-5;
        REQUIRE(settle_to(*problem({1, 1}, fixed), options).end == SettleEnd::settled);
        x = turned(x, angle);
        board.points = turned(board.points, angle);
    }

    double farthest(const Points& start) const {
        double most = 0;
        for (std::size_t i = first; i < x.size(); ++i) most = std::max(most, (x[i] - start[i]).norm());
        return most;
    }
};

struct Slide {
    bool settled = false;
    double mean = 0;     ///< m, farthest that the small sheet was down the slope, mean over its nodes
    double farthest = 0; ///< m, of any of its nodes at the end
};

/// The large sheet is fixed to the board.
Slide slide(const FrictionCoefficients& friction, double angle, double bend) {
    Layers layers(bend);
    layers.tilt(angle, true);
    const Points start = layers.x;
    Slide s;
    const Vec3 down(std::cos(angle), -std::sin(angle), 0);
    SettleOptions options;
    options.max_iterations = 40;
    options.progress = [&](int, double) {
        double mean = 0;
        for (std::size_t i = layers.first; i < start.size(); ++i)
            mean += down.dot(layers.x[i] - start[i]) / double(start.size() - layers.first);
        s.mean = std::max(s.mean, mean);
        return true;
    };
    s.settled = layers.settle_to(*layers.problem(friction, true), options).end == SettleEnd::settled;
    s.farthest = layers.farthest(start);
    return s;
}

} // namespace

TEST_CASE("a sheet on a sheet slides from the angle of their friction on, to 0.15 degrees", "[validation]") {
    for (const FrictionCoefficients& friction : {FrictionCoefficients{0.6, 0.2}, FrictionCoefficients{0.1, 0.5}})
        for (double bend : {1e-5, 1e-3}) {
            INFO("friction of cloth " << friction.cloth << ", bending stiffness " << bend);
            const double limit = std::atan(friction.cloth);
            const Slide held = slide(friction, limit - 0.15 * degree, bend);
            CHECK(held.settled);
            CHECK(held.farthest < 1.1e-4); // what a tie to its place gives before it holds
            const Slide lost = slide(friction, limit + 0.1 * degree, bend);
            CHECK_FALSE(lost.settled);
            CHECK(lost.mean > 1e-3); // far beyond what a tie gives, and on its way
        }
}

TEST_CASE("a layer that lies on another does not creep", "[validation]") {
    const double angle = 12 * degree;
    const FrictionCoefficients friction{0.6, 0.3};
    Layers layers(1e-4);
    layers.tilt(angle, false);
    SettleOptions options;
    const auto first = layers.problem(friction, false);
    REQUIRE(layers.settle_to(*first, options).end == SettleEnd::settled);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(3 * layers.x.size());
    add_gradient(first->cloth_friction, layers.x, g);
    Vec3 held = Vec3::Zero();
    double weight = 0;
    for (int i = layers.first; i < first->points(); ++i) {
        held -= g.segment<3>(3 * i);
        weight += 9.81 * first->node_mass()[i];
    }
    CHECK(held.dot(Vec3(-std::cos(angle), std::sin(angle), 0)) == Approx(std::sin(angle) * weight).epsilon(0.01));

    const Points start = layers.x;
    options.tolerance = 1e-7;
    CHECK(layers.settle_to(*first, options).end == SettleEnd::settled);
    CHECK(layers.farthest(start) < 1e-5);
    layers.x = start;
    options.tolerance = 1e-5;
    CHECK(layers.settle_to(*layers.problem(friction, false, true), options).end == SettleEnd::settled);
    CHECK(layers.farthest(start) < 1e-5);
}
