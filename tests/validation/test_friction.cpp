// SPDX-License-Identifier: GPL-3.0-or-later
// Friction on a body, at the angle at which it gives way: a sheet on a board that is tilted.

#include "draping/cloth.h"
#include "draping/solve/settle.h"

#include "tests/support/flat_mesh.h"
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

// A surface of small unstructured triangles, as avatars have, in the plane y = 0.
TriMesh table() {
    const FlatMesh flat = jittered_rectangle(0.3, 0.2, 0.012, 0.25, 4);
    TriMesh mesh;
    for (const Vec2& p : flat.points)
        mesh.points.push_back({p.x() - 0.1, 0, 0.1 - p.y()});
    mesh.triangles = flat.triangles;
    return mesh;
}

struct Slide {
    bool settled = false;
    double mean = 0;     ///< m, farthest that the sheet was down the slope, mean over its nodes
    double farthest = 0; ///< m, of any node at the end
};

// A sheet of 60 mm comes to rest on a level board, which is then tilted.
Slide slide(double friction, double angle, double bend, TriMesh board) {
    const FlatMesh mesh = jittered_rectangle(0.06, 0.06, 0.01, 0.25, 7);
    const Garment garment = garment_of(mesh);
    Points x;
    for (const Vec2& p : mesh.points)
        x.push_back({p.x() - 0.03, 0.45e-3, p.y() - 0.03});
    SettleOptions options;
    options.tolerance = 1e-5;
    Cholesky factor;
    ClothProblem level(garment, {plain_fabric(2000, bend)}, board, light_barriers());
    level.gravity = 9.81;
    level.rest_here(x, {1});
    REQUIRE(settle(level, x, factor, options).end == SettleEnd::settled);

    x = turned(x, angle);
    board.points = turned(board.points, angle);
    const Points start = x;
    ClothProblem tilted(garment, {plain_fabric(2000, bend)}, board, light_barriers());
    tilted.gravity = 9.81;
    tilted.rest_here(x, {friction});
    Slide s;
    const Vec3 down(std::cos(angle), -std::sin(angle), 0);
    options.tolerance = 1e-3;
    options.max_iterations = 40;
    options.progress = [&](int, double) {
        double mean = 0;
        for (std::size_t i = 0; i < x.size(); ++i)
            mean += down.dot(x[i] - start[i]) / double(x.size());
        s.mean = std::max(s.mean, mean);
        return true;
    };
    s.settled = settle(tilted, x, factor, options).end == SettleEnd::settled;
    for (std::size_t i = 0; i < x.size(); ++i)
        s.farthest = std::max(s.farthest, (x[i] - start[i]).norm());
    return s;
}

void check_angle(const TriMesh& board, double friction, double bend) {
    INFO("friction " << friction << ", bending stiffness " << bend);
    const Slide held = slide(friction, std::atan(friction) - 0.1 * degree, bend, board);
    CHECK(held.settled);
    CHECK(held.farthest < 1.1e-4); // what the tie to its place gives before it holds
    const Slide lost = slide(friction, std::atan(friction) + 0.1 * degree, bend, board);
    CHECK_FALSE(lost.settled);
    CHECK(lost.mean > 1e-3); // far beyond what a tie gives, and on its way
}

} // namespace

TEST_CASE("a sheet on a board slides from the angle of friction on, to 0.1 degrees", "[validation]") {
    const TriMesh board = box(Vec3(-0.5, -0.1, -0.5), Vec3(0.5, 0, 0.5));
    for (double friction : {0.1, 0.3, 0.6, 1.0})
        for (double bend : {1e-5, 1e-4, 1e-3}) // limp as cloth, stiff as a board
            check_angle(board, friction, bend);
}

TEST_CASE("a sheet on a body of small triangles slides from the angle of friction on, to 0.1 degrees",
          "[validation]") {
    for (double friction : {0.1, 0.3, 0.6})
        for (double bend : {1e-5, 1e-3})
            check_angle(table(), friction, bend);
}
