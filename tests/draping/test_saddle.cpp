// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/nonconforming/saddle.h"

#include "draping/nonconforming/rest.h"
#include "tests/support/midpoint_strip.h"

#include <catch2/catch.hpp>

#include <Eigen/Dense>

using namespace toile;
using namespace toile::test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Scene {
    Garment garment;
    NonconformingCloth cloth;
    std::vector<char> held;
    Points x;
    VectorXd lambda, g, c;

    explicit Scene(double most_tension) {
        const FlatMesh mesh = strip_mesh(MeshKind::unstructured, 1, 0.5, 6);
        garment = garment_of(mesh);
        cloth = make_nonconforming_cloth(garment, {sheet_fabric(1, 1)});
        x = midpoints_of(garment, flat_points(mesh));
        held.assign(x.size(), 0);
        held[edges_at_wall(mesh, garment)[1]] = held[3] = held[20] = 1;
        Random random(3);
        const auto fill = [&](VectorXd& v, int size, double low, double high) {
            v.resize(size);
            for (double& entry : v)
                entry = random.in(low, high);
        };
        for (Vec3& p : x)
            p += random.vec3(0.02);
        fill(lambda, int(cloth.bars.size()), 0, most_tension);
        fill(g, int(3 * x.size()), -1, 1);
        fill(c, int(cloth.bars.size()), -1e-3, 1e-3);
    }
};

/// The whole system, dense, with the rows and columns of held points those of the identity.
MatrixXd dense_system(const Scene& s, double shift) {
    const int n = int(3 * s.x.size()), m = int(s.cloth.bars.size());
    MatrixXd a = MatrixXd::Zero(n + m, n + m);
    for (int j = 0; j < s.cloth.bending.stiffness.outerSize(); ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator e(s.cloth.bending.stiffness, j); e; ++e)
            a.block<3, 3>(3 * e.row(), 3 * e.col()) += e.value() * Mat3::Identity();
    a.topLeftCorner(n, n).diagonal().array() += shift;
    for (int i = 0; i < m; ++i) {
        const Bar& bar = s.cloth.bars[i];
        const Mat3 pull = s.lambda[i] / bar.length * Mat3::Identity();
        for (const auto& [p, q, sign] :
             {std::tuple{bar.a, bar.a, 1.0}, {bar.b, bar.b, 1.0}, {bar.a, bar.b, -1.0}, {bar.b, bar.a, -1.0}})
            a.block<3, 3>(3 * p, 3 * q) += sign * pull;
        const Vec3 row = (s.x[bar.a] - s.x[bar.b]) / bar.length;
        a.block<1, 3>(n + i, 3 * bar.a) = row.transpose();
        a.block<1, 3>(n + i, 3 * bar.b) = -row.transpose();
    }
    a.topRightCorner(n, m) = a.bottomLeftCorner(m, n).transpose();
    for (std::size_t i = 0; i < s.held.size(); ++i)
        for (int k = 0; s.held[i] && k < 3; ++k) {
            a.row(3 * i + k).setZero();
            a.col(3 * i + k).setZero();
            a(3 * i + k, 3 * i + k) = 1;
        }
    return a;
}

} // namespace

TEST_CASE("the saddle's solution is that of dense LU", "[saddle]") {
    const Scene s(5);
    Saddle saddle(s.cloth.bending.stiffness, s.cloth.bars, s.held);
    REQUIRE(saddle.factorise(s.cloth.bending.stiffness, 0.5, s.x, s.lambda));
    VectorXd d, y;
    CHECK(saddle.solve(s.g, s.c, d, y));
    const int n = int(d.size()), m = int(y.size());
    VectorXd right(n + m);
    right << -s.g, -s.c;
    for (std::size_t i = 0; i < s.held.size(); ++i)
        if (s.held[i]) right.segment<3>(3 * i).setZero();
    const VectorXd exact = dense_system(s, 0.5).fullPivLu().solve(right);
    CHECK(exact.head(n).norm() > 1e-3);
    CHECK((d - exact.head(n)).norm() < 1e-7 * exact.head(n).norm());
    CHECK((y - exact.tail(m)).norm() < 1e-6 * exact.tail(m).norm());
    CHECK((lengthening(s.cloth.bars, s.x, d) + s.c).norm() < 1e-9 * s.c.norm());
}

TEST_CASE("the saddle tells a minimum from a saddle", "[saddle]") {
    // Pushed from its end, a flat strip keeps its lengths, and buckles once the push passes a bound.
    Scene s(5);
    const auto stands = [&](double push) {
        s.lambda.setConstant(-push);
        const int n = int(3 * s.x.size()), m = int(s.cloth.bars.size());
        const MatrixXd a = dense_system(s, 0.5);
        Saddle saddle(s.cloth.bending.stiffness, s.cloth.bars, s.held);
        const bool found = saddle.factorise(s.cloth.bending.stiffness, 0.5, s.x, s.lambda);
        // Positive along J d = 0: by an orthonormal basis of the null space.
        const MatrixXd j = a.bottomLeftCorner(m, n);
        const Eigen::FullPivLU<MatrixXd> lu(j);
        const MatrixXd basis = MatrixXd(lu.kernel()).householderQr().householderQ() *
                               MatrixXd::Identity(n, lu.dimensionOfKernel());
        const MatrixXd along = basis.transpose() * a.topLeftCorner(n, n) * basis;
        const double least = Eigen::SelfAdjointEigenSolver<MatrixXd>(along).eigenvalues()[0];
        CHECK(found == (least > 0));
        return found;
    };
    CHECK(stands(0));
    CHECK(stands(0.02));
    CHECK_FALSE(stands(5));
}

TEST_CASE("conditions that contradict each other are told", "[saddle]") {
    Scene s(1);
    s.held.assign(s.held.size(), 1);
    Saddle saddle(s.cloth.bending.stiffness, s.cloth.bars, s.held);
    REQUIRE(saddle.factorise(s.cloth.bending.stiffness, 0.5, s.x, s.lambda));
    VectorXd d, y;
    CHECK_FALSE(saddle.solve(s.g, s.c, d, y));
    const IsometricProblem problem{s.cloth.bending.stiffness, Points(s.x.size(), Vec3(0, 0, -1)),
                                   s.cloth.bars, s.held};
    Points x = s.x;
    CHECK(settle_isometric(saddle, problem, x).end == IsometricEnd::not_isometric);
    CHECK(x == s.x);
}
