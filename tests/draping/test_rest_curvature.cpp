// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/rest_curvature.h"
#include "tests/support/curved_cloth.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>

#include <Eigen/Dense>

using namespace toile;
using namespace toile::test;

namespace {

// Cloth with all it can be curved by: bent, twisted and domed.
Vec3 wave(const Vec2& p) { return {p.x(), p.y(), 0.02 * std::sin(12 * p.x() + 5 * p.y()) + 0.2 * p.x() * p.y()}; }

Fabric woven() {
    Fabric f = isotropic(900, 1e-2);
    f.stretch_warp = 2000;
    f.poisson = 0.3;
    f.bend_warp = 2e-2;
    f.bend_poisson = 0.2;
    f.limit_warp = f.limit_weft = 0.05;
    f.limit_shear = 0.1;
    return f;
}

Points shaken(Points x, double by) {
    Random random(5);
    for (Vec3& p : x) p += random.vec3(by);
    return x;
}

// What the energies of a curved plate add up to, said once more and plainly.
double plate_energy(const Cloth& c, const Fabric& fabric, const Points& x) {
    double sum = 0;
    const std::vector<BendRows> rows = bend_rows(c.garment);
    for (std::size_t t = 0; t < rows.size(); ++t) {
        const Triangle n = c.garment.nodes(int(t));
        const Vec3 normal = (x[n[1]] - x[n[0]]).cross(x[n[2]] - x[n[0]]).normalized();
        Mat3 off = -c.garment.rest.curvature[t].col(2) * normal.transpose();
        for (std::size_t a = 0; a < rows[t].nodes.size(); ++a)
            off += rows[t].rows.col(a) * x[rows[t].nodes[a]].transpose();
        sum += 0.5 * rest_area(c.garment.rest.edges[t]) * (off.transpose() * bend_moduli(fabric) * off).trace();
    }
    return sum;
}

} // namespace

TEST_CASE("rest curvature is what the plate's deviation from its rest adds to flat bending", "[rest_curvature]") {
    const Cloth c = pressed(jittered_rectangle(0.3, 0.2, 0.03, 0.3, 5), wave, 0.4);
    const Bending bending = make_bending(c.garment, {woven()});
    const auto curved = make_rest_curvature(c.garment, {woven()});
    for (const double by : {1e-4, 3e-3, 2e-2}) {
        const Points x = shaken(c.x, by);
        CHECK(bend_value(bending, x) + value(curved, x) == Approx(plate_energy(c, woven(), x)).epsilon(1e-9));
    }
}

TEST_CASE("the curvature of a moulded mesh is that of its surface, toward the right side", "[rest_curvature]") {
    const double radius = 0.7, edge = 0.03;
    const auto bowl = [&](const Vec2& p) -> Vec3 {
        return {p.x(), p.y(), radius - std::sqrt(radius * radius - p.squaredNorm())};
    };
    const Cloth c = pressed(jittered_rectangle(0.3, 0.2, edge, 0.3, 5), bowl, 0.4);
    double worst = 0, tangential = 0;
    for (const Mat3& k : c.garment.rest.curvature) {
        worst = std::max(worst, (k.col(2) * radius - Vec3(1, 1, 0)).cwiseAbs().maxCoeff());
        tangential = std::max(tangential, k.leftCols<2>().cwiseAbs().maxCoeff());
    }
    CHECK(worst < 0.02);
    CHECK(worst > 1e-6);
    CHECK(tangential * radius * radius < 2 * edge);
}

TEST_CASE("moulding to a flat shape leaves flat cloth as it is", "[rest_curvature]") {
    const FlatMesh mesh = jittered_rectangle(0.3, 0.2, 0.05, 0.3, 5);
    const Garment flat = garment_of(mesh, 0.4);
    const RestShape rest = moulded(flat, flat_points(mesh));
    for (std::size_t t = 0; t < rest.edges.size(); ++t) {
        CHECK((rest.edges[t] - flat.rest.edges[t]).norm() < 1e-14);
        CHECK(rest.curvature[t].cwiseAbs().maxCoeff() < 1e-9);
    }
    CHECK(make_rest_curvature(flat, {woven()}).empty());
}

TEST_CASE("a sheet has no energy in the shape it was moulded to, creases and all", "[rest_curvature]") {
    const FlatMesh mesh = halved_squares(10, 6, 0.03);
    Garment g = garment_of(mesh, 0.4);
    for (int e = 0; e < g.edges.size(); ++e)
        if (mesh.points[g.edges.ends[e][0]].x() == mesh.points[g.edges.ends[e][1]].x() &&
            std::abs(mesh.points[g.edges.ends[e][0]].x() - 0.15) < 1e-9)
            g.rest.angles[e] = 1;
    Points x;
    for (const Vec2& p : mesh.points) x.push_back(wave(p) + Vec3(0, 0, p.x() > 0.15 ? p.x() - 0.15 : 0));
    g.rest = moulded(g, x);
    Sheet sheet = make_sheet(g, {woven()});
    CHECK(sheet.creases.size() == 6);
    double most = 0;
    for (const RestCurvature& c : sheet.curved) most += c.most;
    Points force(x.size(), Vec3::Zero()), bent = force;
    sheet_gradient(sheet, x, force);
    bend_gradient(sheet.bending, x, bent);
    CHECK(std::abs(sheet_value(sheet, x)) < 1e-10 * most);
    CHECK(flat(force).norm() < 1e-10 * flat(bent).norm());
    CHECK(sheet_value(sheet, shaken(x, 1e-4)) > 1e-4 * most);
}

TEST_CASE("a problem's products are exact for curved cloth", "[rest_curvature]") {
    const Cloth c = pressed(jittered_rectangle(0.3, 0.2, 0.05, 0.3, 5), wave);
    FreeCloth cloth = free_cloth(c.garment, isotropic(10, 1e-2));
    const Points x = shaken(c.x, 3e-3);
    bool changed = false;
    cloth.hessian(x, true, changed);
    Eigen::VectorXd g, d = flat(shaken(Points(x.size(), Vec3::Zero()), 1e-4)), product, difference;
    cloth.gradient(x, g);
    cloth.multiply(d, product);
    cloth.curvature_along(x, g, d, difference);
    CHECK((product - difference).norm() < 1e-4 * difference.norm());
    Eigen::VectorXd part = Eigen::VectorXd::Zero(d.size());
    add_product(make_rest_curvature(c.garment, {isotropic(10, 1e-2)}), x, d, part);
    CHECK(part.norm() > 1e-3 * difference.norm()); // so that its absence would show
}

TEST_CASE("cloth is not moulded to a triangle without area", "[rest_curvature]") {
    const FlatMesh mesh = halved_squares(2, 1, 0.1);
    Points x = flat_points(mesh);
    x[mesh.triangles[1][0]] = x[mesh.triangles[1][1]] = x[mesh.triangles[1][2]];
    CHECK_THROWS_WITH(moulded(garment_of(mesh), x), Catch::Contains("has no area in the shape it is to take"));
    CHECK_THROWS_WITH(moulded(cloth_of(grid(2, 2, 0.1)).garment, grid(2, 2, 0.1).points),
                      Catch::Contains("has no area in the rest shape it had"));
}
