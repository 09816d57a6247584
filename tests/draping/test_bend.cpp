// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/bend.h"

#include "tests/support/flat_mesh.h"

#include <catch2/catch.hpp>

#include <Eigen/Dense>

using namespace toile;
using namespace toile::test;

namespace {

Fabric plate(double warp, double weft, double twist, double coupling) {
    Fabric fabric;
    fabric.name = "plate";
    fabric.bend_warp = warp;
    fabric.bend_weft = weft;
    fabric.bend_twist = twist;
    fabric.bend_poisson = coupling;
    return fabric;
}

double quadratic_energy(const Fabric& f, const Mat2& h) {
    const double c = f.bend_poisson * std::sqrt(f.bend_warp * f.bend_weft);
    return 0.5 * (f.bend_weft * h(0, 0) * h(0, 0) + f.bend_warp * h(1, 1) * h(1, 1) +
                  2 * c * h(0, 0) * h(1, 1) + 4 * f.bend_twist * h(0, 1) * h(0, 1));
}

Points lifted(const FlatMesh& mesh, const Mat2& h) {
    Points x;
    for (const Vec2& p : mesh.points)
        x.push_back({p.x(), p.y(), 0.5 * p.dot(h * p)});
    return x;
}

Mat2 symmetric(double uu, double vv, double uv) {
    Mat2 h;
    h << uu, uv, uv, vv;
    return h;
}

} // namespace

TEST_CASE("bending energy is exact on quadratics, borders included", "[bend]") {
    const Fabric fabric = plate(3, 1, 0.7, 0.25);
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const FlatMesh mesh = jittered_rectangle(1, 0.25, 0.05, 0.3, seed);
        const Bending bending = make_bending(garment_of(mesh), {fabric});
        for (const Mat2& h :
             {symmetric(1, 0, 0), symmetric(0, 1, 0), symmetric(0, 0, 1), symmetric(1, -2, 0.5)})
            CHECK(bend_value(bending, lifted(mesh, h)) ==
                  Approx(0.25 * quadratic_energy(fabric, h)).epsilon(1e-9));
    }
}

TEST_CASE("a seam between different grains does not change bending", "[bend]") {
    const FlatMesh mesh = jittered_rectangle(1, 0.5, 0.07, 0.3, 3);
    const Fabric isotropic = plate(2, 2, 0.7, 0.3);
    const Mat2 h = symmetric(1, -2, 0.5);
    const double whole = bend_value(make_bending(garment_of(mesh), {isotropic}), lifted(mesh, h));
    const double sewn =
        bend_value(make_bending(cut_and_sewn(mesh, 0.45, 0.2, 1.3), {isotropic, isotropic}), lifted(mesh, h));
    CHECK(sewn == Approx(whole).epsilon(1e-10));
}

TEST_CASE("a plate bent to a quadratic is in equilibrium inside", "[bend]") {
    // The dual patch test: constant curvature asks for no force on a node that no border stencil reaches. A
    // fit per triangle that neighbours do not share fails it, and is too soft at every resolution.
    const FlatMesh mesh = jittered_rectangle(1, 1, 0.08, 0.3, 11);
    const Bending bending = make_bending(garment_of(mesh), {plate(3, 1, 0.7, 0.25)});
    const Points x = lifted(mesh, symmetric(1, -2, 0.5));
    Points gradient(x.size(), Vec3::Zero());
    bend_gradient(bending, x, gradient);
    double inside = 0, all = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Vec2& p = mesh.points[i];
        const double border = std::min(p.minCoeff(), 1 - p.maxCoeff());
        all = std::max(all, gradient[i].norm());
        if (border > 0.35) inside = std::max(inside, gradient[i].norm());
    }
    CHECK(all > 0.1);
    CHECK(inside < 1e-10 * all);
}

TEST_CASE("bending is positive semidefinite and blind to affine maps only", "[bend]") {
    const FlatMesh mesh = jittered_rectangle(0.5, 0.25, 0.05, 0.3, 5);
    const Bending bending = make_bending(garment_of(mesh), {plate(3, 1, 0.7, 0.25)});
    const Eigen::MatrixXd k = bending.stiffness;
    CHECK((k - k.transpose()).cwiseAbs().maxCoeff() < 1e-10 * k.cwiseAbs().maxCoeff());
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k, Eigen::EigenvaluesOnly).eigenvalues();
    const double largest = values[values.size() - 1];
    CHECK(std::abs(values[0]) < 1e-11 * largest);
    CHECK(values[2] < 1e-11 * largest);
    CHECK(values[3] > 1e-6 * largest);
}

TEST_CASE("the compact form is close to the exact one", "[bend]") {
    const FlatMesh mesh = jittered_rectangle(0.6, 0.3, 0.05, 0.3, 6);
    const Garment garment = garment_of(mesh);
    const Bending bending = make_bending(garment, {plate(3, 1, 0.7, 0.25)});
    const int n = garment.node_count;
    Eigen::MatrixXd compact = Eigen::MatrixXd::Zero(n, n);
    for (const BendElement& e : bending.compact)
        for (int a = 0; a < e.count; ++a)
            for (int b = 0; b < e.count; ++b)
                compact(e.nodes[a], e.nodes[b]) += e.stiffness(a, b);
    // Affine maps, which both are blind to, filled up.
    Eigen::MatrixXd affine(n, 3);
    for (int i = 0; i < n; ++i)
        affine.row(i) << 1, mesh.points[i].x(), mesh.points[i].y();
    const Eigen::MatrixXd q =
        Eigen::HouseholderQR<Eigen::MatrixXd>(affine).householderQ() * Eigen::MatrixXd::Identity(n, 3);
    CHECK((compact * affine).cwiseAbs().maxCoeff() < 1e-10 * compact.cwiseAbs().maxCoeff());
    const Eigen::MatrixXd fill = compact.cwiseAbs().maxCoeff() * q * q.transpose();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> ratio(
        Eigen::MatrixXd(bending.stiffness) + fill, compact + fill, Eigen::EigenvaluesOnly);
    INFO("exact over compact: " << ratio.eigenvalues()[0] << " to " << ratio.eigenvalues()[n - 1]);
    CHECK(ratio.eigenvalues()[0] > 0.2);
    CHECK(ratio.eigenvalues()[n - 1] < 20);
}

TEST_CASE("a fabric that cannot resist bending is refused by name", "[bend]") {
    const FlatMesh mesh = jittered_rectangle(0.2, 0.2, 0.1, 0, 1);
    CHECK_THROWS_WITH(make_bending(garment_of(mesh), {plate(1, 0, 1, 0)}), Catch::Contains("plate"));
}
