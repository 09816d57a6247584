// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/fast_projection.h"

#include "draping/energy/yarns.h"

#include "tests/support/flat_mesh.h"

#include <catch2/catch.hpp>

#include <Eigen/Dense>

using namespace toile;
using namespace toile::test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double dt = 2e-3;

/// A piece of cloth, rough, that was moved to where its yarns have not their lengths.
struct Moved {
    Garment garment = garment_of(halved_squares(7, 5, 0.02));
    std::vector<LengthConstraint> yarns = yarn_edges(garment);
    std::vector<double> lengths;
    Points start, x;
    std::vector<Mat3> mobility;

    explicit Moved(double by) {
        Random random(4);
        for (const Vec2& p : garment.uv) {
            start.push_back({p.x(), p.y(), 0});
            x.push_back(start.back() + random.vec3(by));
            Mat3 square = Mat3::Identity();
            for (double& c : square.reshaped()) c += random.in(-0.2, 0.2);
            mobility.push_back(square * square.transpose() / 6e-5);
        }
        for (const int pinned : {0, 27}) {
            mobility[pinned].setZero();
            x[pinned] = start[pinned];
        }
        for (const LengthConstraint& c : yarns) lengths.push_back(c.length);
    }
    ProjectionDone project(std::vector<double>& tension) {
        FastProjection projection(int(x.size()), yarns);
        return projection.project(mobility, dt, lengths, start, x, tension);
    }
};

MatrixXd jacobian(const std::vector<LengthConstraint>& constraints, const Points& x) {
    MatrixXd j = MatrixXd::Zero(constraints.size(), 3 * x.size());
    for (std::size_t k = 0; k < constraints.size(); ++k) {
        const Vec3 s = slope(constraints[k], x);
        j.row(k).segment<3>(3 * constraints[k].a) -= s;
        j.row(k).segment<3>(3 * constraints[k].b) += s;
    }
    return j;
}

} // namespace

TEST_CASE("lengths: the gradient of a constraint by finite differences", "[inextensible]") {
    const Moved m(2e-3);
    const MatrixXd j = jacobian(m.yarns, m.x);
    Random random(9);
    VectorXd d(3 * m.x.size());
    for (double& c : d) c = random.in(-1, 1);
    const double step = 1e-6;
    Points ahead = m.x, behind = m.x;
    flat(ahead) += step * d;
    flat(behind) -= step * d;
    for (std::size_t k = 0; k < m.yarns.size(); ++k) {
        const double difference =
            (violation(m.yarns[k], m.lengths[k], ahead) - violation(m.yarns[k], m.lengths[k], behind)) / (2 * step);
        CHECK(difference == Approx(j.row(k).dot(d)).epsilon(1e-7).margin(1e-8));
        CHECK(j.row(k).norm() == Approx(std::sqrt(2.0)).epsilon(0.3));
    }
}

TEST_CASE("fast projection: an iteration is that of the dense formula", "[inextensible]") {
    Moved m(2e-4);
    Points expected = m.x;
    const int n = int(m.x.size());
    const MatrixXd j = jacobian(m.yarns, m.start);
    MatrixXd w = MatrixXd::Zero(3 * n, 3 * n);
    for (int i = 0; i < n; ++i) w.block<3, 3>(3 * i, 3 * i) = m.mobility[i];
    VectorXd c = j * (flat(m.x) - flat(m.start));
    for (std::size_t k = 0; k < m.yarns.size(); ++k) c[k] += violation(m.yarns[k], m.lengths[k], m.start);
    const VectorXd change = (dt * dt * j * w * j.transpose()).ldlt().solve(c);
    flat(expected) -= dt * dt * w * j.transpose() * change;

    FastProjection projection(n, m.yarns);
    projection.options.tolerance = 1; // met after one
    std::vector<double> tension(m.yarns.size(), 0.0);
    const ProjectionDone done = projection.project(m.mobility, dt, m.lengths, m.start, m.x, tension);
    CHECK(done.iterations == 1);
    double most = 0;
    for (int i = 0; i < n; ++i) most = std::max(most, (m.x[i] - expected[i]).norm());
    CHECK(most < 1e-10);
    for (std::size_t k = 0; k < m.yarns.size(); ++k)
        CHECK(tension[k] == Approx(change[k]).epsilon(1e-4).margin(1e-5 * change.cwiseAbs().maxCoeff()));
}

TEST_CASE("fast projection: lengths are reached in a few iterations, and pinned points stay", "[inextensible]") {
    for (const double by : {1e-4, 1e-3, 4e-3}) {
        Moved m(by);
        const Points before = m.x;
        std::vector<double> tension(m.yarns.size(), 0.0);
        const ProjectionDone done = m.project(tension);
        INFO("moved by " << by << " m: " << done.iterations << " iterations");
        CHECK(done.converged);
        CHECK(done.strain <= 1e-8);
        CHECK(done.iterations <= 10);
        for (const LengthConstraint& c : m.yarns) CHECK(std::abs(strain(c, m.x)) <= 1e-8);
        CHECK(m.x[0] == before[0]);
        CHECK(m.x[27] == before[27]);
    }
}

TEST_CASE("fast projection: what holds a point that is at rest is along its line, however long the step", "[inextensible]") {
    // A weight on a thread that is neither along it nor across: J of the place where the force has led would turn it.
    const Points start{{0, 0, 0}, {0.6, -0.8, 0}};
    FastProjection projection(2, {{0, 1, 1.0}});
    const double mass = 0.1;
    for (const double step : {1e-3, 0.1}) {
        Points x = start;
        x[1] += step * step / mass * 3.0 * Vec3(0.6, -0.8, 0);
        std::vector<double> tension{0};
        const auto done = projection.project({Mat3::Zero(), Mat3::Identity() / mass}, step, {1.0}, start, x, tension);
        CHECK(done.converged);
        CHECK((x[1] - start[1]).norm() < 1e-8);
        CHECK(tension[0] == Approx(3).epsilon(1e-6));
    }
}

TEST_CASE("fast projection: lengths that cannot be reached are said to be, and what depends on others is no trouble",
          "[inextensible]") {
    // A chain between two pins that is a little too short; and just long enough, where the constraints depend on each other.
    for (const double length : {0.49, 0.5}) {
        const Points start{{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}};
        Points x = start;
        x[1].y() = -1e-6;
        FastProjection projection(3, {{0, 1, length}, {1, 2, length}});
        std::vector<double> tension{0, 0};
        const std::vector<Mat3> mobility{Mat3::Zero(), Mat3(Mat3::Identity() / 0.1), Mat3::Zero()};
        const ProjectionDone done = projection.project(mobility, dt, {length, length}, start, x, tension);
        CHECK(done.converged == (length == 0.5));
        CHECK(done.strain >= (length == 0.5 ? 0 : 0.5 / 0.49 - 1 - 1e-9));
        CHECK(done.iterations <= projection.options.max_iterations);
        CHECK((x[1] - start[1]).norm() < 0.01);
        CHECK(std::abs(tension[0]) < 100);
    }
}

TEST_CASE("yarns: edges along warp and weft are kept, diagonals are not, and fewer than could move", "[inextensible]") {
    const Garment g = garment_of(halved_squares(7, 5, 0.02));
    CHECK(yarn_edges(g).size() == 7 * 6 + 8 * 5);
    for (const LengthConstraint& c : yarn_edges(g)) CHECK(c.length == Approx(0.02));
    CHECK(yarn_edges(garment_of(halved_squares(7, 5, 0.02), 0.3)).empty());
    CHECK(yarn_edges(garment_of(halved_squares(7, 5, 0.02), EIGEN_PI / 4)).size() == 7 * 5); // the diagonals
    // A sliver all of whose edges lie along the warp has as many as it has shapes.
    CHECK_THROWS_WITH(yarn_edges(garment_of({{{0, 0}, {0.001, 0.05}, {0, 0.1}}, {{0, 1, 2}}})), Catch::Contains("no motion"));
}
