// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/strain_limit.h"

#include "draping/cloth.h"
#include "tests/support/flat_mesh.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace toile;
using namespace toile::test;

namespace {

Fabric limited(double warp, double weft, double shear) {
    Fabric f;
    f.name = "limited";
    f.stretch_warp = f.stretch_weft = 1000;
    f.shear = 50;
    f.limit_warp = warp;
    f.limit_weft = weft;
    f.limit_shear = shear;
    return f;
}

} // namespace

TEST_CASE("strain limits are silent below 60 %, rise steeply to the limit and go on from there", "[strain_limit]") {
    const FlatMesh mesh = jittered_rectangle(0.2, 0.2, 0.05, 0.2, 2);
    const Fabric f = limited(0.01, 0.02, 0.3);
    std::vector<StrainLimit> limits = make_strain_limits(garment_of(mesh), {f});
    const auto stretched = [&](double weft, double warp, double angle) {
        Points x;
        for (const Vec2& p : mesh.points)
            x.push_back({(1 + weft) * p.x() + (1 + warp) * std::sin(angle) * p.y(),
                         (1 + warp) * std::cos(angle) * p.y(), 0});
        return x;
    };
    const auto at = [&](double weft, double warp, double angle) {
        return strain_limit_value(limits, stretched(weft, warp, angle));
    };
    CHECK(at(0.0118, 0.0059, 0.17) == 0);
    CHECK(at(-0.5, -0.5, 0) == 0);
    CHECK(at(0.013, 0, 0) > 0);
    CHECK(at(0, 0.0065, 0) > 0);
    CHECK(at(0, 0, 0.2) > 0);
    CHECK(at(0, 0, -0.2) > 0);
    // Against what the membrane holds at the limit: 1/2 k e^2 per area.
    const double membrane = 0.5 * 1000 * 0.01 * 0.01 * 0.04;
    CHECK(at(0, 0.01, 0) > membrane);
    const double soft = at(0, 0.01, 0), beyond = at(0, 0.02, 0);
    CHECK(std::isfinite(beyond));
    CHECK(beyond > 5 * soft);
    for (StrainLimit& limit : limits) limit.turn = 0.99;
    CHECK(at(0, 0.0085, 0) < soft);
    CHECK(at(0, 0.01, 0) > soft);
    CHECK(at(0, 0.011, 0) > 100 * soft);

    CHECK(beyond_strain_limits(limits, stretched(0.0199, 0.0099, 0)).empty());
    CHECK(beyond_strain_limits(limits, stretched(0, 0, 0.299)).empty());
    CHECK(beyond_strain_limits(limits, stretched(0.0201, 0, 0)).size() == limits.size());
    CHECK(beyond_strain_limits(limits, stretched(0, 0.0101, 0)).size() == limits.size());
    CHECK(beyond_strain_limits(limits, stretched(0, 0, -0.301)).size() == limits.size());
    Points x = stretched(0, 0, 0);
    const int t = 3;
    const Garment garment = garment_of(mesh);
    x[garment.nodes(t)[0]] += 0.05 * (x[garment.nodes(t)[0]] - x[garment.nodes(t)[1]]);
    const std::vector<int> some = beyond_strain_limits(limits, x);
    CHECK(std::find(some.begin(), some.end(), t) != some.end());
    CHECK(some.size() < limits.size() / 2);
}

TEST_CASE("a strip that hangs from far beyond its limit comes to rest within it", "[strain_limit]") {
    // One triangle, its first two corners held: the third is drawn back until the limit balances its load.
    StrainLimit limit = make_strain_limits(garment_of({{{0, 0}, {0.1, 0}, {0, 0.1}}, {{0, 1, 2}}}),
                                           {limited(0.02, 0.02, 0.4)})[0];
    limit.turn = 0.97;
    Points x{{0, 0, 0}, {0.1, 0, 0}, {0, 0.12, 0}};
    const double load = 1000 * 0.02 * 0.1; // N: twice what the membrane holds at the limit
    for (int i = 0; i < 60; ++i) {
        Points g(3, Vec3::Zero());
        strain_limit_gradient({limit}, x, g);
        Eigen::Matrix<double, 9, 9> h;
        if (!strain_limit_hessian(limit, x, HessianKind::projected, h)) break;
        x[2].y() -= (g[2].y() - load) / h(7, 7);
    }
    CHECK(x[2].y() < 0.102);
    CHECK(x[2].y() > 0.1012);
}

TEST_CASE("limits may be drawn in, and none stays none", "[strain_limit]") {
    const FlatMesh mesh = jittered_rectangle(0.2, 0.2, 0.05, 0.2, 5);
    const Barrier unused{0.5e-3, 0.5e-4, 1e6};
    const auto value = [&](Fabric fabric, double strain, double tighter) {
        fabric.density = 0.15;
        fabric.bend_warp = fabric.bend_weft = fabric.bend_twist = 1e-5;
        ClothProblem problem(garment_of(mesh), {fabric}, {}, {unused, unused, false});
        problem.limit_strain(0.99, tighter);
        Points x;
        for (const Vec2& p : mesh.points) x.push_back({p.x(), (1 + strain) * p.y(), 0});
        problem.arrive(x);
        return problem.value(x);
    };
    const Fabric some = limited(0.02, 0.02, 0.3), drawn_in = limited(0.018, 0.018, 0.3), none = limited(0, 0, 0);
    CHECK(value(some, 0.0185, 0.1) > 10 * value(some, 0.0185, 0));
    CHECK(value(some, 0.0175, 0.1) == Approx(value(drawn_in, 0.0175, 0)).epsilon(0.3)); // of other stiffness
    CHECK(value(none, 0.0185, 0.1) == value(none, 0.0185, 0));
    CHECK(std::isfinite(value(none, 0.0185, 0)));
}
