// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/rest/sag_free.h"
#include "tests/support/shapes.h"

#include <catch2/catch.hpp>

#include <Eigen/Dense>

#include <random>

using namespace toile;

namespace {

struct Case {
    std::vector<Member> members;
    Points load;
    std::vector<char> held;
};

/// A ball held at its lower half, with weight and a little wind.
Case ball() {
    const TriMesh mesh = test::sphere(0.1, 2);
    Prescribed data = measured(mesh.triangles, mesh.points);
    data.length_weight.assign(data.edges.size(), 0.03);
    data.angle_weight.assign(data.edges.size(), 1e-5);
    Case c{members_of(data, mesh.points), weight_of(mesh.triangles, mesh.points, 0.2, 9.81), {}};
    std::mt19937_64 random(1);
    for (Vec3& f : c.load)
        for (int k = 0; k < 3; ++k) f[k] += 1e-3 * (double(random() >> 11) * 0x1p-53 - 0.5);
    for (const Vec3& p : mesh.points) c.held.push_back(p.y() < 0);
    return c;
}

double along(const Member& m, const Eigen::VectorXd& v) {
    double sum = 0;
    for (int k = 0; k < m.count; ++k) sum += m.slope[k].dot(v.segment<3>(3 * m.nodes[k]));
    return sum;
}

double inside(const Member& m, double force) { return std::min(force - m.low, m.high - force) / (m.high - m.low); }

/// How far forces are from the least sum of force^2 / stiffness: the displacement that those inside their bounds show, by a
/// dense solver, has to press the others against theirs. As a share of the largest force.
double off_least(const Case& c, const Balance& b) {
    std::vector<Eigen::VectorXd> rows;
    std::vector<double> values;
    double most = 0;
    for (std::size_t j = 0; j < c.members.size(); ++j) {
        const Member& m = c.members[j];
        most = std::max(most, std::abs(b.force[j]));
        if (inside(m, b.force[j]) < 1e-9) continue;
        Eigen::VectorXd row = Eigen::VectorXd::Zero(3 * Eigen::Index(c.load.size()));
        for (int k = 0; k < m.count; ++k)
            if (!c.held[m.nodes[k]]) row.segment<3>(3 * m.nodes[k]) = m.slope[k];
        rows.push_back(row);
        values.push_back(b.force[j] / m.stiffness);
    }
    Eigen::MatrixXd a(rows.size(), 3 * c.load.size());
    for (std::size_t k = 0; k < rows.size(); ++k) a.row(Eigen::Index(k)) = rows[k].transpose();
    const Eigen::VectorXd u =
        a.completeOrthogonalDecomposition().solve(Eigen::Map<Eigen::VectorXd>(values.data(), Eigen::Index(values.size())));
    double off = 0;
    for (std::size_t j = 0; j < c.members.size(); ++j) {
        const Member& m = c.members[j];
        off = std::max(off, std::abs(std::clamp(m.stiffness * along(m, u), m.low, m.high) - b.force[j]));
    }
    return off / most;
}

/// What other forces within the bounds could take off half the sum of squares of what is missing, at most.
double could_gain(const Case& c, const Balance& b) {
    double gain = 0;
    for (std::size_t j = 0; j < c.members.size(); ++j) {
        const double slope = along(c.members[j], flat(b.missing));
        gain += slope * ((slope > 0 ? c.members[j].high : c.members[j].low) - b.force[j]);
    }
    return gain;
}

} // namespace

TEST_CASE("balance: the least forces that hold a load, within bounds that leave less and less room") {
    Case c = ball();
    const Balance free = balance(c.members, c.load, c.held);
    REQUIRE(free.end == BalanceEnd::balanced);
    CHECK(free.factorisations == 1);
    CHECK(off_least(c, free) < 1e-9);
    double most_length = 0, most_angle = 0;
    for (std::size_t j = 0; j < c.members.size(); ++j) {
        double& most = c.members[j].count == 2 ? most_length : most_angle;
        most = std::max(most, std::abs(free.force[j]));
    }
    int met = 0, not_met = 0;
    for (double share = 1.4; share > 0.05; share *= 0.93) {
        for (Member& m : c.members) {
            m.high = share * (m.count == 2 ? most_length : most_angle);
            m.low = -0.7 * m.high;
        }
        const Balance b = balance(c.members, c.load, c.held);
        CAPTURE(share, b.factorisations);
        for (std::size_t j = 0; j < c.members.size(); ++j) {
            REQUIRE(b.force[j] >= c.members[j].low);
            REQUIRE(b.force[j] <= c.members[j].high);
        }
        if (b.end == BalanceEnd::balanced) {
            ++met;
            CHECK(off_least(c, b) < 1e-6);
        } else {
            ++not_met;
            CHECK(b.end == BalanceEnd::nearest);
            const double squares = flat(b.missing).squaredNorm();
            CHECK(squares > 1e-9 * flat(c.load).squaredNorm());
            CHECK(could_gain(c, b) < 2e-6 * squares);
        }
    }
    CHECK(met >= 2);
    CHECK(not_met >= 2);
}

TEST_CASE("balance: what nothing holds is missing") {
    Case c = ball();
    c.held.assign(c.held.size(), 0);
    Balance b = balance(c.members, c.load, c.held);
    CHECK(b.end == BalanceEnd::nearest);
    Vec3 load = Vec3::Zero(), missing = Vec3::Zero();
    for (const Vec3& f : c.load) load += f;
    for (const Vec3& f : b.missing) missing += f;
    CHECK((load - missing).norm() < 1e-9 * load.norm());

    b = balance({}, c.load, c.held);
    CHECK(b.end == BalanceEnd::nearest);
    CHECK(flat(b.missing) == flat(c.load));

    c.load.assign(c.load.size(), Vec3::Zero());
    b = balance(c.members, c.load, c.held);
    CHECK(b.end == BalanceEnd::balanced);
    for (const double f : b.force) CHECK(f == 0);
    c.held.assign(c.held.size(), 1);
    CHECK(balance(c.members, ball().load, c.held).end == BalanceEnd::balanced);
}
