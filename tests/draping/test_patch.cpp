// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/patch.h"

#include "tests/support/flat_mesh.h"

#include <catch2/catch.hpp>

#include <Eigen/Geometry>

using namespace toile;
using namespace toile::test;

namespace {

// q_k of every patch, for nodes at x.
Mat3 edge_turning(const Patch& patch, const Points& x) {
    Mat3 q = Mat3::Zero(); // row k
    for (int a = 0; a < patch.count; ++a)
        q += patch.curve.col(a) * x[patch.nodes[a]].transpose();
    return q;
}

// Largest error of q against that of the quadratic 1/2 p^T H p in mesh coordinates, over the exact largest q.
double worst_error(const Garment& garment, const FlatMesh& mesh, const Mat2& hessian) {
    Points x;
    for (const Vec2& p : mesh.points)
        x.push_back({p.x(), p.y(), 0.5 * p.dot(hessian * p) + 0.3 * p.x() - p.y() + 2});
    const std::vector<Patch> patches = make_patches(garment);
    double error = 0, scale = 0;
    for (std::size_t t = 0; t < patches.size(); ++t) {
        const Mat3 q = edge_turning(patches[t], x);
        const Triangle nodes = garment.nodes(int(t));
        for (int k = 0; k < 3; ++k) {
            const Vec2 e = mesh.points[nodes[(k + 2) % 3]] - mesh.points[nodes[(k + 1) % 3]];
            const double exact = e.dot(hessian * e);
            error = std::max(error, (q.row(k) - Vec3(0, 0, exact).transpose()).norm());
            scale = std::max(scale, std::abs(exact));
        }
    }
    return error / scale;
}

const std::vector<Mat2> quadratics = [] {
    std::vector<Mat2> h(3);
    h[0] << 1, 0, 0, 0;
    h[1] << 0.3, 0.7, 0.7, -1;
    h[2] << 0, 1, 1, 0;
    return h;
}();

} // namespace

TEST_CASE("a patch is exact on quadratics, at borders too", "[patch]") {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const FlatMesh mesh = jittered_rectangle(1, 0.25, 0.05, 0.3, seed);
        for (const Mat2& h : quadratics)
            CHECK(worst_error(garment_of(mesh, 0.4), mesh, h) < 1e-10);
    }
}

TEST_CASE("a patch is exact on quadratics of structured meshes, whose nodes lie on lines", "[patch]") {
    FlatMesh mesh;
    for (int j = 0; j <= 4; ++j)
        for (int i = 0; i <= 6; ++i)
            mesh.points.push_back({0.1 * i, 0.1 * j});
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 6; ++i) {
            const int a = 7 * j + i;
            mesh.triangles.push_back({a, a + 1, a + 8});
            mesh.triangles.push_back({a, a + 8, a + 7});
        }
    for (const Mat2& h : quadratics)
        CHECK(worst_error(garment_of(mesh), mesh, h) < 1e-10);
}

TEST_CASE("a patch sees across a seam between different grains", "[patch]") {
    const FlatMesh mesh = jittered_rectangle(1, 0.5, 0.07, 0.3, 3);
    const Garment sewn = cut_and_sewn(mesh, 0.45, 0.2, 1.3);
    REQUIRE(sewn.uv.size() > std::size_t(sewn.node_count));
    for (const Mat2& h : quadratics)
        CHECK(worst_error(sewn, mesh, h) < 1e-10);
}

TEST_CASE("a patch does not see rigid motions and affine maps", "[patch]") {
    const FlatMesh mesh = jittered_rectangle(1, 0.25, 0.05, 0.3, 7);
    const Garment garment = garment_of(mesh);
    const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
    Random random(4);
    Points x, moved;
    for (const Vec2& p : mesh.points) {
        x.push_back({p.x(), p.y(), 0.2 * std::sin(9 * p.x() + p.y()) + 0.01 * random.in(-1, 1)});
        moved.push_back(turn * x.back() + Vec3(5, -3, 2));
    }
    double error = 0, affine = 0, size = 0;
    const Points plane = flat_points(mesh);
    for (const Patch& patch : make_patches(garment)) {
        const Mat3 q = edge_turning(patch, x), r = edge_turning(patch, moved);
        error = std::max(error, (q * turn.transpose() - r).norm());
        affine = std::max(affine, edge_turning(patch, plane).norm());
        size = std::max(size, q.norm());
    }
    CHECK(size > 0.01);
    CHECK(error < 1e-12);
    CHECK(affine < 1e-14);
}

TEST_CASE("stencils stay of moderate size on rough meshes and at their corners", "[patch]") {
    // On a regular mesh the largest entry is 2. A large one would amplify noise.
    double largest = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const FlatMesh mesh = jittered_rectangle(1, 0.4, 0.05, 0.3, seed);
        for (const Patch& patch : make_patches(garment_of(mesh))) {
            CHECK(patch.count >= 6);
            largest = std::max(largest, patch.curve.cwiseAbs().maxCoeff());
        }
    }
    CHECK(largest > 1);
    CHECK(largest < 20);
}

TEST_CASE("cloth too small to show a curvature has none", "[patch]") {
    FlatMesh one;
    one.points = {{0, 0}, {1, 0}, {0, 1}};
    one.triangles = {{0, 1, 2}};
    const Patch alone = make_patches(garment_of(one))[0];
    CHECK(alone.count == 3);
    CHECK(alone.curve.isZero());

    // A strip one triangle wide: bent along it is seen, bent across it is not.
    FlatMesh strip;
    for (int i = 0; i <= 8; ++i)
        for (int j = 0; j <= 1; ++j)
            strip.points.push_back({1.0 * i, 1.0 * j});
    for (int i = 0; i < 8; ++i) {
        strip.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 3});
        strip.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 1});
    }
    const Garment garment = garment_of(strip);
    Points along, across;
    for (const Vec2& p : strip.points) {
        along.push_back({p.x(), p.y(), 0.5 * p.x() * p.x()});
        across.push_back({p.x(), p.y(), 0.5 * p.y() * (p.y() - 1)});
    }
    const std::vector<Patch> patches = make_patches(garment);
    for (int t = 4; t < 12; ++t) {
        const Vec3 bent = curvature_of_edges(garment.rest.edges[t]) * edge_turning(patches[t], along).col(2);
        CHECK(bent.x() == Approx(1).margin(0.3));
        CHECK(edge_turning(patches[t], across).norm() < 1e-12);
    }
}

TEST_CASE("curvature of edges inverts the directional derivatives", "[patch]") {
    Mat2 edges;
    edges << 0.3, -0.1, 0.05, 0.4;
    const Mat2 h = quadratics[1];
    const Vec2 e2 = edges.col(0), e1 = -edges.col(1), e0 = edges.col(1) - edges.col(0);
    const Vec3 q(e0.dot(h * e0), e1.dot(h * e1), e2.dot(h * e2));
    const Vec3 c = curvature_of_edges(edges) * q;
    CHECK(c.x() == Approx(h(0, 0)));
    CHECK(c.y() == Approx(h(1, 1)));
    CHECK(c.z() == Approx(h(0, 1)));
}
