// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/cloth_part.h"

#include "tests/support/cloth_scene.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

namespace {

/// Two sheets of poplin, one on the other, on a ball, on their way to rest.
ClothScene layers_on_a_ball() {
    const FlatMesh sheet = jittered_rectangle(0.3, 0.3, 0.025, 0.25, 3);
    FlatMesh all = sheet;
    add_sheet(all, sheet, 1);
    Points x;
    for (std::size_t i = 0; i < all.points.size(); ++i) {
        const Vec2 p = sheet.points[i % sheet.points.size()] - Vec2(0.15, 0.15);
        x.emplace_back(p.x(), i < sheet.points.size() ? 0.104 : 0.108, -p.y());
    }
    ClothScene scene(garment_of(all), sphere(0.1, 3), x, fabric_preset("poplin"), {0.3, 0.3});
    scene.problem->limit_strain(0.7);
    scene.problem->pin(0);
    scene.problem->hooks.push_back({5, Vec3(0, 0.3, 0), Vec3::Ones(), 10, 0.1});
    scene.settle_to(1e-3, 60);
    return scene;
}

/// Of both sheets, what lies beyond this far to one side.
std::vector<char> beyond(const Points& x, double side) {
    std::vector<char> moving;
    for (const Vec3& p : x) moving.push_back(p.x() < side);
    return moving;
}

Points places(const ClothPart& part, const Points& x) {
    Points at;
    for (const int i : part.nodes) at.push_back(x[i]);
    return at;
}

/// Random, of what moves alone.
Eigen::VectorXd shake(const ClothScene& scene, const std::vector<char>& moving, double size) {
    Random random(11);
    Eigen::VectorXd d = Eigen::VectorXd::Zero(3 * Eigen::Index(moving.size()));
    for (int i = 0; i < int(moving.size()); ++i)
        if (moving[i] && !scene.problem->pinned()[i]) d.segment<3>(3 * i) = random.vec3(size);
    return d;
}

Eigen::VectorXd of_part(const ClothPart& part, const Eigen::VectorXd& d) {
    Eigen::VectorXd own(3 * Eigen::Index(part.nodes.size()));
    for (std::size_t k = 0; k < part.nodes.size(); ++k) own.segment<3>(3 * k) = d.segment<3>(3 * part.nodes[k]);
    return own;
}

/// How far two vectors differ where cloth moves, as a share of the second.
double off(const Eigen::VectorXd& own, Eigen::VectorXd whole, const ClothPart& part, const std::vector<char>& moving) {
    double difference = 0, size = 0;
    for (std::size_t k = 0; k < part.nodes.size(); ++k) {
        const int i = part.nodes[k];
        if (!moving[i]) continue;
        difference = std::max(difference, (own.segment<3>(3 * k) - whole.segment<3>(3 * i)).norm());
        size = std::max(size, whole.segment<3>(3 * i).norm());
    }
    return difference / size;
}

} // namespace

TEST_CASE("a part of a cloth feels what the whole feels there", "[cloth_part]") {
    const double travel = 0.01;
    ClothScene scene = layers_on_a_ball();
    ClothProblem& whole = *scene.problem;
    const Points& x = scene.x;
    const std::vector<char> moving = beyond(x, -0.03);
    const ClothPart part = part_of(whole, x, moving, travel);
    ClothProblem& own = *part.problem;
    const Points at = places(part, x);
    CHECK(part.nodes.size() < 0.8 * x.size());
    REQUIRE(!whole.cloth_friction.ties.empty());
    whole.arrive(x);
    own.arrive(at);

    Eigen::VectorXd g, own_g;
    whole.gradient(x, g);
    own.gradient(at, own_g);
    CHECK(off(own_g, g, part, moving) < 1e-10);
    CHECK(off(own_g, Eigen::VectorXd::Zero(g.size()), part, moving) > 0); // of a state that is not at rest

    const Eigen::VectorXd d = shake(scene, moving, 2e-5), own_d = of_part(part, d);
    Points shaken = x, own_shaken = at;
    flat(shaken) += d;
    flat(own_shaken) += own_d;
    const double change = whole.value(shaken) - whole.value(x), own_change = own.value(own_shaken) - own.value(at);
    CHECK(std::abs(own_change - change) < 1e-8 * std::abs(change));

    bool changed = false;
    Eigen::VectorXd h, own_h;
    whole.hessian(x, true, changed);
    own.hessian(at, true, changed);
    whole.multiply(d, h);
    own.multiply(own_d, own_h);
    CHECK(off(own_h, h, part, moving) < 1e-10);

    const Eigen::VectorXd far = shake(scene, moving, 0.9 * travel / std::sqrt(3.0));
    const double t = whole.feasible_step(x, far);
    CHECK(t < 1);
    CHECK(own.feasible_step(at, of_part(part, far)) == Approx(t).epsilon(1e-12));

    Points gone = x, own_gone = at;
    flat(gone) += t * far;
    flat(own_gone) += t * of_part(part, far);
    whole.arrive(gone);
    own.arrive(own_gone);
    whole.gradient(gone, g);
    own.gradient(own_gone, own_g);
    CHECK(off(own_g, g, part, moving) < 1e-8); // with the friction of what slid
}

TEST_CASE("what still moves is settled by itself", "[cloth_part]") {
    ClothScene scene = layers_on_a_ball();
    ClothProblem& whole = *scene.problem;
    Eigen::VectorXd step = Eigen::VectorXd::Zero(3 * Eigen::Index(scene.x.size()));
    for (std::size_t i = 0; i < scene.x.size(); ++i)
        if (scene.x[i].x() < -0.1 && scene.x[i].z() > 0.1 && !whole.pinned()[i]) step[3 * i + 1] = 1e-3;
    step *= whole.feasible_step(scene.x, step);
    flat(scene.x) += step;
    whole.arrive(scene.x);
    Eigen::VectorXd g;
    whole.gradient(scene.x, g);
    const double before = whole.residual(scene.x, g), energy = whole.value(scene.x);
    const Points start = scene.x;

    SettleOptions o;
    CHECK(relax_part(whole, scene.x, step, before, 0.025, o) > 0);
    whole.arrive(scene.x);
    whole.gradient(scene.x, g);
    CHECK(whole.value(scene.x) < energy);
    CHECK(whole.residual(scene.x, g) < 0.5 * before);
    CHECK(scene.crossings() == 0);
    int moved = 0;
    double farthest = 0;
    for (std::size_t i = 0; i < start.size(); ++i) {
        moved += scene.x[i] != start[i];
        farthest = std::max(farthest, (scene.x[i] - start[i]).norm());
    }
    CHECK(moved > 0);
    CHECK(moved < int(start.size()) / 3);
    CHECK(farthest < 0.025);

    const Points rest = scene.x;
    CHECK(relax_part(whole, scene.x, step, 1, 0.025, o) == 0); // all but at rest: the whole is quicker
    CHECK(relax_part(whole, scene.x, Eigen::VectorXd::Ones(step.size()), before, 0.025, o) == 0); // all moves
    CHECK(scene.x == rest);
}
