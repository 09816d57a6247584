// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/strain_limit.h"

#include "tests/support/flat_mesh.h"

#include <catch2/catch.hpp>

#include <Eigen/Dense>

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

// How far the worst triangle is, as a share of its limit, measured anew: stretch by lengths, shear by angles.
double worst_share(const Garment& garment, const Fabric& f, const Points& x) {
    double worst = 0;
    for (int t = 0; t < int(garment.triangles.size()); ++t) {
        const Triangle n = garment.nodes(t);
        Eigen::Matrix<double, 3, 2> edges;
        edges << x[n[1]] - x[n[0]], x[n[2]] - x[n[0]];
        const Eigen::Matrix<double, 3, 2> yarns = edges * garment.rest.edges[t].inverse();
        const double angle = std::abs(std::acos(yarns.col(0).normalized().dot(yarns.col(1).normalized())) -
                                      0.5 * 3.14159265358979323846);
        worst = std::max({worst, (yarns.col(0).norm() - 1) / f.limit_weft,
                          (yarns.col(1).norm() - 1) / f.limit_warp, angle / f.limit_shear});
    }
    return worst;
}

} // namespace

TEST_CASE("strain limits are silent below 60 % and infinite at the limit", "[strain_limit]") {
    const FlatMesh mesh = jittered_rectangle(0.2, 0.2, 0.05, 0.2, 2);
    const Fabric f = limited(0.01, 0.02, 0.3);
    const std::vector<StrainLimit> limits = make_strain_limits(garment_of(mesh), {f});
    const auto at = [&](double weft, double warp, double angle) {
        Points x;
        for (const Vec2& p : mesh.points)
            x.push_back({(1 + weft) * p.x() + (1 + warp) * std::sin(angle) * p.y(),
                         (1 + warp) * std::cos(angle) * p.y(), 0});
        return strain_limit_value(limits, x);
    };
    CHECK(at(0.0118, 0.0059, 0.17) == 0);
    CHECK(at(-0.5, -0.5, 0) == 0);
    CHECK(at(0.013, 0, 0) > 0);
    CHECK(at(0, 0.0065, 0) > 0);
    CHECK(at(0, 0, 0.2) > 0);
    CHECK(at(0, 0, -0.2) > 0);
    CHECK(std::isfinite(at(0.0199, 0.0099, 0)));
    CHECK(std::isfinite(at(0, 0, 0.299)));
    CHECK(std::isinf(at(0.0201, 0, 0)));
    CHECK(std::isinf(at(0, 0.0101, 0)));
    CHECK(std::isinf(at(0, 0, 0.301)));
}

TEST_CASE("the largest step ends at the limit and not behind it", "[strain_limit]") {
    const FlatMesh mesh = jittered_rectangle(0.3, 0.2, 0.05, 0.3, 9);
    const Garment garment = garment_of(mesh, 0.4);
    const Fabric f = limited(0.05, 0.03, 0.2);
    const std::vector<StrainLimit> limits = make_strain_limits(garment, {f});
    Random random(5);
    int stopped = 0;
    for (int trial = 0; trial < 200; ++trial) {
        Points x, direction;
        const double size =
            std::pow(10.0, random.in(-5, 1)); // long steps pass the limit, and come back out of it
        for (const Vec2& p : mesh.points) {
            x.push_back(Vec3(p.x(), p.y(), 0) + random.vec3(2e-4));
            direction.push_back(random.vec3(size));
        }
        int where = -2;
        const double step = strain_limit_step(limits, x, direction, &where);
        REQUIRE(step > 0);
        REQUIRE(step <= 1);
        stopped += step < 1;
        CHECK((where >= 0) == (step < 1));
        for (double share : {1.0, 0.999, 0.7, 0.3, 0.01}) {
            Points y = x;
            for (std::size_t i = 0; i < y.size(); ++i)
                y[i] += share * step * direction[i];
            CHECK(worst_share(garment, f, y) < 1 + 1e-6);
            if (share < 1) CHECK(std::isfinite(strain_limit_value(limits, y)));
            if (share == 1 && step < 1) CHECK(worst_share(garment, f, y) > 1 - 2e-3);
        }
    }
    CHECK(stopped > 50);
    CHECK(stopped < 200);
}

TEST_CASE("limits can be widened for a start that violates them", "[strain_limit]") {
    const FlatMesh mesh = jittered_rectangle(0.2, 0.2, 0.05, 0.2, 2);
    const Garment garment = garment_of(mesh);
    std::vector<StrainLimit> limits = make_strain_limits(garment, {limited(0.01, 0.01, 0.1)});
    Points x;
    for (const Vec2& p : mesh.points)
        x.push_back({p.x() < 0.1 ? p.x() : 1.2 * p.x() - 0.02, p.y() + 0.3 * p.x(), 0});
    REQUIRE(std::isinf(strain_limit_value(limits, x)));
    const int changed = widen_strain_limits(limits, x, 0.05);
    CHECK(changed > 0);
    CHECK(std::isfinite(strain_limit_value(limits, x)));
    CHECK(widen_strain_limits(limits, x, 0.04) == 0);
}
