// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/rest/sag_free.h"
#include "draping/rest/nearest.h"
#include "draping/solve/free_cloth.h"
#include "draping/solve/settle.h"
#include "tests/support/shapes.h"
#include "tests/support/surfaces.h"

#include <catch2/catch.hpp>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <random>

using namespace toile;

namespace {

constexpr double gravity = 9.81;

/// A chain of `links` on x >= 0, level, and a held one before it: squares of `size`, each of two triangles. Point 2 j + side
/// lies at x = (j - 1) size.
TriMesh chain(int links, double size) {
    TriMesh m;
    for (int j = -1; j <= links; ++j)
        for (int side = 0; side < 2; ++side) m.points.emplace_back(j * size, 0, side * size);
    for (int a = 0; a < 2 * (links + 1); a += 2) {
        m.triangles.push_back({a, a + 1, a + 3});
        m.triangles.push_back({a, a + 3, a + 2});
    }
    return m;
}

/// Cloth that bends with `bend` (N m) and stretches with `stretch` (N/m).
Prescribed cloth(const TriMesh& mesh, double bend, double stretch = 1000) {
    Prescribed data = measured(mesh.triangles, mesh.points);
    Fabric fabric;
    fabric.stretch_warp = fabric.stretch_weft = stretch;
    fabric.bend_warp = fabric.bend_weft = bend;
    weigh(data, fabric);
    return data;
}

std::vector<double> masses(const TriMesh& mesh, double density) {
    std::vector<double> mass;
    for (const Vec3& w : weight_of(mesh.triangles, mesh.points, density, 1)) mass.push_back(-w.y());
    return mass;
}

double farthest(const Points& a, const Points& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
    return most;
}

/// What the energy leaves without answer at a free point, N.
double unanswered(const Prescribed& rest, const Points& x, const Points& load, const std::vector<char>& held) {
    Eigen::VectorXd g = -flat(load);
    PrescribedEnergy(rest).add_gradient(x, g);
    double most = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
        if (!held[i]) most = std::max(most, g.segment<3>(3 * i).norm());
    return most;
}

/// Where cloth of this rest shape comes to rest under its weight.
Points settled(const Prescribed& rest, const std::vector<double>& mass, const std::vector<char>& held, Points x) {
    FreeCloth problem(std::make_unique<PrescribedEnergy>(rest), mass);
    problem.gravity = gravity;
    for (std::size_t i = 0; i < held.size(); ++i)
        if (held[i]) problem.pin(int(i));
    Cholesky factor;
    SettleOptions options;
    options.tolerance = 1e-8;
    const SettleResult r = settle(problem, x, factor, options);
    CAPTURE(r.residual, r.iterations);
    CHECK(r.end == SettleEnd::settled);
    return x;
}

/// Free points moved by up to `reach` in every direction, the same way every time.
Points moved(Points x, const std::vector<char>& held, double reach) {
    std::mt19937_64 random(3);
    for (std::size_t i = 0; i < x.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const double unit = double(random() >> 11) * 0x1p-53;
            if (!held[i]) x[i][c] += reach * (2 * unit - 1);
        }
    return x;
}

/// A cap of a sphere on the level y = 0.
TriMesh dome(double radius, int rounds) {
    const TriMesh ball = test::sphere(radius, rounds);
    TriMesh cap;
    std::vector<int> place(ball.points.size(), -1);
    for (std::size_t i = 0; i < ball.points.size(); ++i)
        if (ball.points[i].y() > -1e-12) {
            place[i] = int(cap.points.size());
            cap.points.push_back(ball.points[i]);
        }
    for (const Triangle& t : ball.triangles)
        if (place[t[0]] >= 0 && place[t[1]] >= 0 && place[t[2]] >= 0)
            cap.triangles.push_back({place[t[0]], place[t[1]], place[t[2]]});
    return cap;
}

} // namespace

TEST_CASE("sag-free: a chain held level at one end, and its drape") {
    // Cut at node i, the part beyond is held by the hinge there alone: phi_i = (l / B) g sum_{j > i} m_j (s_j - s_i), however
    // the links are split. Continuous: phi0' = gamma / 2 at the root, a turn of gamma / 6 in all.
    const int links = 40;
    const double size = 0.01, length = links * size, density = 0.2;
    const TriMesh mesh = chain(links, size);
    const std::vector<double> mass = masses(mesh, density);
    std::vector<char> held(mesh.points.size(), 0);
    std::fill_n(held.begin(), 4, 1);
    const Points load = weight_of(mesh.triangles, mesh.points, density, gravity);
    for (const double gamma : {1.0, 10.0, 50.0}) {
        const double bend = density * gravity * std::pow(length, 3) / gamma;
        const Prescribed data = cloth(mesh, bend, 1e6);
        const SagFree found = sag_free(data, mesh.points, load, held);
        CAPTURE(gamma, found.factorisations, found.missing[found.worst].norm());
        REQUIRE(found.end == BalanceEnd::balanced);
        CHECK(found.stable);
        double turn = 0;
        for (int e = 0; e < data.edges.size(); ++e) {
            const auto& [a, b] = data.edges.ends[e];
            CHECK(found.rest.length[e] == Approx(data.length[e]).epsilon(1e-12));
            if (a % 2 != 0 || b != a + 1 || data.edges.triangles_at(e) != 2) continue;
            const int i = a / 2;
            double wanted = 0;
            for (std::size_t p = 0; p < mass.size(); ++p)
                if (int(p / 2) > i) wanted += mass[p] * gravity * (int(p / 2) - i) * size;
            wanted *= size / (bend * size);
            const double phi = std::abs(found.rest.angle[e]);
            if (i >= 1) CHECK(phi == Approx(wanted).epsilon(1e-6));
            if (i == 1) CHECK(phi / size * length == Approx(gamma / 2).epsilon(1e-6));
            if (i >= 1) turn += i == 1 ? phi / 2 : phi; // the hinge at the root is half within the clamp
        }
        CHECK(turn == Approx(gamma / 6 * (1 + 0.5 / (links * links))).epsilon(1e-6));
        const Points x = settled(found.rest, mass, held, moved(mesh.points, held, 0.05 * size));
        CHECK(farthest(x, mesh.points) < 1e-6 * length);
    }
    // Cloth that gives way sideways as easily turns over, and that is told.
    const Prescribed soft = cloth(mesh, density * gravity * std::pow(length, 3) / 50, 1000);
    const SagFree found = sag_free(soft, mesh.points, load, held);
    CHECK(found.end == BalanceEnd::balanced);
    CHECK_FALSE(found.stable);
}

TEST_CASE("sag-free: a dome held at its rim hangs as it was modelled, upright and upside down") {
    const double radius = 0.1, density = 0.15;
    for (const double up : {1.0, -1.0}) {
        TriMesh mesh = dome(radius, 3);
        std::vector<char> held;
        for (Vec3& p : mesh.points) {
            held.push_back(std::abs(p.y()) < 1e-12);
            p.y() *= up;
        }
        const Points load = weight_of(mesh.triangles, mesh.points, density, gravity);
        const SagFree found = sag_free(cloth(mesh, 1e-5), mesh.points, load, held);
        CAPTURE(up, found.factorisations);
        REQUIRE(found.end == BalanceEnd::balanced);
        CHECK(found.stable);
        CHECK(found.length_bounds.empty());
        CHECK(found.angle_bounds.empty());
        CHECK(unanswered(found.rest, mesh.points, load, held) < 1e-9);
        const std::vector<double> mass = masses(mesh, density);
        CHECK(farthest(settled(found.rest, mass, held, mesh.points), mesh.points) < 1e-9);
        CHECK(farthest(settled(found.rest, mass, held, moved(mesh.points, held, 1e-4)), mesh.points) < 1e-8);
        // As measured, without what was found, it sags.
        CHECK(farthest(settled(cloth(mesh, 1e-5), mass, held, mesh.points), mesh.points) > 1e-9);
    }
}

TEST_CASE("sag-free: a dome that is too heavy would stand as it was modelled, but not come back") {
    TriMesh mesh = dome(0.1, 2);
    std::vector<char> held;
    for (const Vec3& p : mesh.points) held.push_back(std::abs(p.y()) < 1e-12);
    int stable = 0, unstable = 0;
    for (double density = 0.15; density < 300; density *= 3) {
        const Points load = weight_of(mesh.triangles, mesh.points, density, gravity);
        SagFreeOptions options;
        options.length_change = 0.5;
        options.angle_change = M_PI;
        const SagFree found = sag_free(cloth(mesh, 1e-5), mesh.points, load, held, options);
        if (found.end != BalanceEnd::balanced) continue;
        std::vector<std::pair<int, int>> pairs;
        const PrescribedEnergy energy(found.rest);
        energy.couplings(pairs);
        BlockMatrix h(int(mesh.points.size()), pairs);
        energy.add_hessian(mesh.points, HessianKind::exact, h);
        h.pin(held);
        Eigen::MatrixXd dense(h.rows(), h.rows());
        Eigen::VectorXd column;
        for (int k = 0; k < h.rows(); ++k) {
            h.multiply(Eigen::VectorXd::Unit(h.rows(), k), column);
            dense.col(k) = column;
        }
        const double lowest = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense, Eigen::EigenvaluesOnly).eigenvalues()[0];
        CAPTURE(density, lowest);
        CHECK(found.stable == (lowest > 0));
        ++(lowest > 0 ? stable : unstable);
    }
    CHECK(stable > 0);
    CHECK(unstable > 0);
}

TEST_CASE("sag-free: a level sheet that may not change its angles lacks all of its weight") {
    const TriMesh flat_sheet = test::grid(8, 8, 0.05);
    TriMesh mesh = flat_sheet;
    for (Vec3& p : mesh.points) p = {p.x(), 0, p.y()};
    std::vector<char> held(mesh.points.size(), 0);
    for (const int corner : {0, 8, 72, 80}) held[corner] = 1;
    Points load = weight_of(mesh.triangles, mesh.points, 0.2, gravity);
    load[40].y() -= 0.003; // a button
    const Prescribed data = cloth(mesh, 0.1);
    SagFreeOptions options;
    options.angle_change = 0;
    const SagFree found = sag_free(data, mesh.points, load, held, options);
    CHECK(found.end == BalanceEnd::nearest);
    CHECK(found.worst == 40);
    CHECK_FALSE(found.stable);
    for (std::size_t i = 0; i < load.size(); ++i)
        CHECK((found.missing[i] - (held[i] ? Vec3::Zero() : load[i])).norm() < 1e-9 * load[40].norm());
    // With the angles it hangs level.
    CHECK(sag_free(data, mesh.points, load, held).end == BalanceEnd::balanced);
}

TEST_CASE("sag-free: within bounds that are too narrow, the nearest is returned, and what it lacks") {
    TriMesh mesh = dome(0.1, 2);
    std::vector<char> held;
    for (const Vec3& p : mesh.points) held.push_back(std::abs(p.y()) < 1e-12);
    const Points load = weight_of(mesh.triangles, mesh.points, 0.15, gravity);
    const Prescribed data = cloth(mesh, 1e-5);
    SagFreeOptions options;
    options.angle_change = 0.01;
    const SagFree wide = sag_free(data, mesh.points, load, held, options);
    CHECK(wide.end == BalanceEnd::balanced);
    double most = 0;
    for (int e = 0; e < data.edges.size(); ++e) most = std::max(most, std::abs(wide.rest.length[e] / data.length[e] - 1));
    for (const double share : {0.9, 0.5, 0.1}) {
        options.length_change = share * most;
        const SagFree found = sag_free(data, mesh.points, load, held, options);
        CAPTURE(share, found.factorisations, int(found.end), found.length_bounds.size(), found.angle_bounds.size());
        CHECK(found.end != BalanceEnd::gave_up);
        CHECK_FALSE(found.length_bounds.empty());
        for (int e = 0; e < data.edges.size(); ++e)
            CHECK(std::abs(found.rest.length[e] / data.length[e] - 1) < options.length_change * (1 + 1e-9));
        CHECK(unanswered(found.rest, mesh.points, load, held) == Approx(found.missing[found.worst].norm()).margin(1e-12));
    }
}

TEST_CASE("sag-free: forces are linear in tensions and moments, and their slopes those of the energy") {
    const TriMesh mesh = dome(0.1, 1);
    const Points x = moved(mesh.points, std::vector<char>(mesh.points.size(), 0), 0.01);
    Prescribed data = cloth(mesh, 1e-3);
    std::mt19937_64 random(5);
    const auto unit = [&] { return double(random() >> 11) * 0x1p-53; };
    for (int e = 0; e < data.edges.size(); ++e) {
        data.length[e] *= 0.8 + 0.4 * unit();
        data.angle[e] += unit() - 0.5;
    }
    const std::vector<Member> members = members_of(data, x);
    const std::vector<Hinge> hinges = hinges_of(data.edges, data.triangles);
    const auto gradient = [&](const Prescribed& of) {
        Eigen::VectorXd g = Eigen::VectorXd::Zero(3 * x.size());
        PrescribedEnergy(of).add_gradient(x, g);
        return g;
    };
    // All at once.
    const std::vector<double> angles = angles_of(data, x);
    Eigen::VectorXd sum = gradient(data);
    const double size = sum.norm();
    for (std::size_t k = 0; k < members.size(); ++k) {
        const Member& m = members[k];
        const bool length = k < data.edges.ends.size();
        const int e = length ? int(k) : hinges[k - data.edges.ends.size()].edge;
        const double distance = (x[m.nodes[1]] - x[m.nodes[0]]).norm();
        const double force = length ? tension_of(data.length_weight[e], distance, data.length[e])
                                    : m.stiffness * (angles[e] - data.angle[e]);
        if (length) CHECK(length_for(data.length_weight[e], distance, force) == Approx(data.length[e]).epsilon(1e-12));
        for (int c = 0; c < m.count; ++c) sum.segment<3>(3 * m.nodes[c]) -= force * m.slope[c];
    }
    CHECK(sum.norm() < 1e-12 * size);
    // One by one, from where the cloth is at rest.
    const Prescribed rest = [&] {
        Prescribed r = measured(data.triangles, x);
        r.length_weight = data.length_weight;
        r.angle_weight = data.angle_weight;
        return r;
    }();
    const double h = 1e-6;
    for (std::size_t k = 0; k < members.size(); ++k) {
        const Member& m = members[k];
        const bool length = k < data.edges.ends.size();
        const int e = length ? int(k) : hinges[k - data.edges.ends.size()].edge;
        Prescribed more = rest, less = rest;
        const double step = length ? h * rest.length[e] : h;
        (length ? more.length : more.angle)[e] += step;
        (length ? less.length : less.angle)[e] -= step;
        Eigen::VectorXd slope = (gradient(more) - gradient(less)) / (2 * step);
        const double scale = slope.norm();
        for (int c = 0; c < m.count; ++c) slope.segment<3>(3 * m.nodes[c]) += m.stiffness * m.slope[c];
        CHECK(slope.norm() < 1e-8 * scale);
    }
}
