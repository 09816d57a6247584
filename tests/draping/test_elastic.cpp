// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/energy/elastic.h"

#include "tests/support/energy_checks.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

namespace {

const FlatMesh& mesh() {
    static const FlatMesh m = jittered_rectangle(0.3, 0.2, 0.05, 0.3, 5);
    return m;
}

/// Bands along all sides of the first triangles, at a share of their length.
std::vector<ElasticSegment> bands(double ratio) {
    std::vector<ElasticSegment> segments;
    for (std::size_t t = 0; t < mesh().triangles.size(); t += 3)
        for (int k = 0; k < 3; ++k) {
            const int a = mesh().triangles[t][k], b = mesh().triangles[t][(k + 1) % 3];
            segments.push_back({a, b, ratio * (mesh().points[a] - mesh().points[b]).norm(), 40});
        }
    return segments;
}

Eigen::MatrixXd dense(const std::vector<ElasticSegment>& segments, const Points& x) {
    std::vector<std::pair<int, int>> pairs;
    couplings(segments, pairs);
    BlockMatrix h(int(x.size()), pairs);
    h.set_zero();
    add_hessian(segments, x, h);
    Eigen::MatrixXd all(h.rows(), h.rows());
    for (int i = 0; i < h.rows(); ++i) {
        Eigen::VectorXd column;
        h.multiply(Eigen::VectorXd::Unit(h.rows(), i), column);
        all.col(i) = column;
    }
    return all;
}

TestedEnergy elastic_energy(const std::vector<ElasticSegment>& segments) {
    return {"elastic", [segments](const Points& x) { return value(segments, x); },
            [segments](const Points& x, Points& g) {
                Eigen::VectorXd sum = Eigen::VectorXd::Zero(3 * Eigen::Index(x.size()));
                add_gradient(segments, x, sum);
                flat(g) += sum;
            },
            [segments](const Points& x, HessianKind) { return dense(segments, x); }};
}

} // namespace

TEST_CASE("elastic: gradient and Hessian by finite differences, rigid motions, convex model", "[energies]") {
    for (const TestedState& state : tested_states(mesh()))
        if (state.name != "collapsed") check_energy(elastic_energy(bands(0.5)), state);
}

TEST_CASE("an elastic band pulls by its strain and never pushes") {
    const std::vector<ElasticSegment> band{{0, 1, 0.08, 40}};
    const Points taut{Vec3(0, 1, 0), Vec3(0.1, 1, 0)}, slack{Vec3(0, 1, 0), Vec3(0.079, 1, 0)};
    Eigen::VectorXd g = Eigen::VectorXd::Zero(6);
    add_gradient(band, taut, g);
    CHECK(strain(band[0], taut) == Approx(0.25));
    CHECK(g[3] == Approx(10)); // 40 N per unit strain
    CHECK(g[0] == Approx(-10));
    CHECK(value(band, taut) == Approx(0.5 * 40 * 0.08 * 0.25 * 0.25));
    g.setZero();
    add_gradient(band, slack, g);
    CHECK(g.norm() == 0);
    CHECK(value(band, slack) == 0);
    CHECK(dense(band, slack).norm() == 0);
}
