// SPDX-License-Identifier: GPL-3.0-or-later
// Springs against what theory says of them: moduli, waves, swings, and what their steps bear.

#include "draping/energy/spring_mesh.h"
#include "draping/solve/explicit.h"
#include "draping/solve/implicit.h"
#include "draping/solve/limited.h"
#include "draping/solve/stability.h"
#include "tests/support/energy_checks.h"
#include "tests/support/flat_mesh.h"
#include "tests/support/free_springs.h"
#include "tests/support/plain_fabric.h"

#include <catch2/catch.hpp>

#include <Eigen/Dense>

#include <cmath>
#include <numbers>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double pi = std::numbers::pi;

/// Second derivative of the energy per area by the strain (xx, yy, 2 xy) of cloth that is deformed evenly.
Eigen::Matrix3d elasticity(const std::vector<Spring>& springs, const Points& flat_x, double area) {
    const Springs energy(springs);
    const auto value = [&](const Eigen::Vector3d& e) {
        Points x = flat_x;
        for (Vec3& p : x)
            p = Vec3((1 + e[0]) * p.x() + 0.5 * e[2] * p.y(), 0.5 * e[2] * p.x() + (1 + e[1]) * p.y(), 0);
        return energy.value(x) / area;
    };
    Eigen::Matrix3d c;
    const double s = 1e-4;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const Eigen::Vector3d a = s * Eigen::Vector3d::Unit(i), b = s * Eigen::Vector3d::Unit(j);
            c(i, j) = (value(a + b) - value(a - b) - value(b - a) + value(-a - b)) / (4 * s * s);
        }
    return c;
}

/// Modulus of a strip along a direction, N/m: 1 / (d d S d d).
double modulus(const Eigen::Matrix3d& c, double angle) {
    const Vec2 d(std::cos(angle), std::sin(angle));
    const Eigen::Vector3d n(d.x() * d.x(), d.y() * d.y(), d.x() * d.y());
    return 1 / n.dot(c.inverse() * n);
}

/// The sheet of the reference: 11 x 11 nodes, 0.5 m, 0.2 kg/m2.
const SpringGrid sheet{11, 11, 0.05};

/// Frequency (rad/s) of what was let go from its largest amplitude: by its first two crossings of zero downwards.
template <class Amplitude, class Step>
double swing(double dt, const Amplitude& amplitude, const Step& step) {
    std::vector<double> crossings;
    double last = amplitude();
    for (int i = 1; crossings.size() < 2 && i < 200000; ++i) {
        step();
        const double now = amplitude();
        if (last > 0 && now <= 0) crossings.push_back((i - 1 + last / (last - now)) * dt);
        last = now;
    }
    REQUIRE(crossings.size() == 2);
    return 2 * pi / (crossings[1] - crossings[0]);
}

/// The velocities of implicit Euler swing slower by 1 - (w dt)^2 / 3 and lose w dt / 2 of w in amplitude: the steps are
/// chosen for both to be small.
template <class S>
constexpr double share_of_period = 1.0 / 2000;
template <>
constexpr double share_of_period<ExplicitStepper> = 1.0 / 200;

} // namespace

TEST_CASE("springs: cells with one diagonal are five times as stiff along it as across", "[springs]") {
    // Per cell of spacing 1, springs k along both lines give C = k sum n n n n: C_11 = C_22 = k. The diagonal, of length
    // sqrt 2, gives 2 k n n n n. In axes along and across it, lines have n = (1, +-1) / sqrt 2: C_11 = C_22 = C_12 = k / 2; the
    // diagonal adds 2 k to C_11. Strips that are free to narrow: E = C_11 - C_12^2 / C_22 = 2 k along, and across
    // C_22 - C_12^2 / C_11 = k / 2 - k / 10 = 2 k / 5.
    const double k = 100;
    const SpringGrid grid{21, 21, 0.02};
    const std::vector<Spring> springs = grid_springs(grid, {k, k, k, 0, 0}, Diagonals::one);
    const Eigen::Matrix3d c = elasticity(springs, grid_points(grid), 0.4 * 0.4);
    CHECK(modulus(c, pi / 4) == Approx(2 * k).epsilon(0.02));
    CHECK(modulus(c, -pi / 4) == Approx(0.4 * k).epsilon(0.02));
    CHECK(modulus(c, pi / 4) / modulus(c, -pi / 4) == Approx(5).epsilon(0.02));
    // With both diagonals nothing tells them apart.
    const std::vector<Spring> both = grid_springs(grid, {k, k, k, 0, 0}, Diagonals::both);
    const Eigen::Matrix3d d = elasticity(both, grid_points(grid), 0.4 * 0.4);
    CHECK(modulus(d, pi / 4) == Approx(modulus(d, -pi / 4)).epsilon(1e-4));
}

TEST_CASE("springs: a grid has the moduli of its fabric", "[springs]") {
    Fabric f = plain_fabric(1000, 1e-5);
    f.stretch_weft = 600;
    f.shear = 200;
    const SpringGrid grid{21, 21, 0.02};
    for (const Diagonals diagonals : {Diagonals::both, Diagonals::one}) {
        const auto springs = grid_springs(grid, grid_stiffness(f, diagonals), diagonals);
        const Eigen::Matrix3d c = elasticity(springs, grid_points(grid), 0.4 * 0.4);
        CHECK(modulus(c, 0) == Approx(600).epsilon(1e-3));
        CHECK(modulus(c, pi / 2) == Approx(1000).epsilon(1e-3));
        CHECK(c(2, 2) == Approx(200).epsilon(1e-3));
    }
    f.shear = 5000;
    f.stretch_weft = 10;
    CHECK_THROWS_AS(grid_stiffness(f, Diagonals::both), std::invalid_argument);
}

TEST_CASE("springs: along the edges of an even mesh they are a sheet with a Poisson ratio of a third", "[springs]") {
    Fabric f = plain_fabric(600, 1e-5);
    f.poisson = 1.0 / 3;
    f.shear = 600 / (2 * (1 + f.poisson));
    const FlatMesh mesh = jittered_rectangle(0.4, 0.4, 0.02, 0.0, 5);
    const Eigen::Matrix3d c = elasticity(mesh_springs(garment_of(mesh), {f}), flat_points(mesh), 0.4 * 0.4);
    for (const double angle : {0.0, pi / 4, pi / 2}) CHECK(modulus(c, angle) == Approx(600).epsilon(0.05));
    CHECK(c(0, 1) / c(0, 0) == Approx(1.0 / 3).epsilon(0.1));
}

TEST_CASE("springs: flat cloth is in balance, and resists curving as its fabric does", "[springs]") {
    Fabric f = plain_fabric(600, 1e-5);
    const FlatMesh mesh = jittered_rectangle(0.4, 0.4, 0.02, 0.2, 5);
    const Springs energy(mesh_springs(garment_of(mesh), {f}));
    const Points flat_x = flat_points(mesh);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(3 * Eigen::Index(flat_x.size()));
    energy.add_gradient(flat_x, g);
    CHECK(g.cwiseAbs().maxCoeff() < 1e-9);
    // Rolled to a cylinder, along and across: 1/2 B k^2 per area, less the hinges that a border lacks.
    const double curvature = 0.5;
    for (const bool along : {true, false}) {
        Points x;
        for (const Vec2& p : mesh.points) {
            const double s = along ? p.x() : p.y(), other = along ? p.y() : p.x();
            x.push_back(Vec3(std::sin(curvature * s) / curvature, other, (1 - std::cos(curvature * s)) / curvature));
        }
        const double chords = 0.5 * 600 * std::pow(curvature * 0.02, 4) / 576; // of edges, which are strained by it
        CHECK(chords < 0.02 * 0.5 * 1e-5 * curvature * curvature);
        CHECK((energy.value(x) - energy.value(flat_x)) / 0.16 ==
              Approx(0.5 * 1e-5 * curvature * curvature).epsilon(0.15));
    }
}

namespace {

/// All springs alike: along lines, across cells both ways, and over two edges.
std::vector<Spring> equal_springs(double k) {
    std::vector<Spring> springs = grid_springs(sheet, {k, k, k, 0, 0}, Diagonals::both);
    const auto over_two = [&](int i, int j, int di, int dj) {
        if (i + di >= sheet.columns || j + dj >= sheet.rows) return;
        Spring s{i + sheet.columns * j, i + di + sheet.columns * (j + dj), 2 * sheet.spacing};
        s.stiffness = k;
        springs.push_back(s);
    };
    for (int j = 0; j < sheet.rows; ++j)
        for (int i = 0; i < sheet.columns; ++i) over_two(i, j, 2, 0), over_two(i, j, 0, 2);
    for (Spring& s : springs) s.stiffness = k; // at borders too
    return springs;
}

const std::vector<double> equal_mass(121, 0.2 * 0.25 / 121);

/// Whether a sheet that is shaken a little swings on without bounds at steps of so many seconds.
bool blows_up(const std::vector<Spring>& springs, double substep) {
    Points x = grid_points(sheet);
    Random random(3);
    for (Vec3& p : x) p += Vec3(random.in(-1, 1), random.in(-1, 1), 0) * 1e-7;
    FreeSprings<ExplicitStepper> s(springs, equal_mass, x, substep);
    s.stepper.substep = substep;
    const double start = s.energy();
    for (int i = 0; i < 800; ++i) {
        s.step();
        if (!(s.energy() < 1e3 * start)) return true;
    }
    return false;
}

} // namespace

TEST_CASE("springs: explicit steps blow up from 2 / w on and not before", "[springs]") {
    const std::array<double, 3> stiffness{50, 500, 5000}, reference{1849e-6, 584.7e-6, 184.9e-6};
    for (int k = 0; k < 3; ++k) {
        const std::vector<Spring> springs = equal_springs(stiffness[k]);
        FreeCloth problem(std::make_unique<Springs>(springs), equal_mass);
        const double limit = fastest(problem, grid_points(sheet)).step();
        CHECK(limit == Approx(reference[k]).epsilon(0.002));
        bool changed = false;
        const Eigen::MatrixXd all = dense(problem.hessian(grid_points(sheet), false, changed)) / equal_mass[0];
        const double w2 = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(all, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
        CHECK(limit == Approx(2 / std::sqrt(w2)).epsilon(0.005));
        CHECK(!blows_up(springs, 0.98 * reference[k]));
        CHECK(blows_up(springs, 1.02 * reference[k]));
    }
}

TEST_CASE("springs: the fastest motion is followed from place to place", "[springs]") {
    Fabric f = plain_fabric(100, 1e-5);
    const FlatMesh mesh = jittered_rectangle(0.2, 0.2, 0.0125, 0.25, 7);
    SpringMeshOptions how;
    how.damping_time = 1e-3;
    FreeCloth problem(std::make_unique<Springs>(mesh_springs(garment_of(mesh), {f}, how)), std::vector<double>(mesh.points.size(), 1e-4));
    Points x = flat_points(mesh);
    FastestMotions motions;
    Random random(11);
    for (int k = 0; k < 20; ++k) {
        const double followed = fastest(problem, x, &motions).step();
        CHECK(followed == Approx(fastest(problem, x).step()).epsilon(0.01));
        for (Vec3& p : x) p += 2e-4 * Vec3(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1));
    }
    x[x.size() / 2] += Vec3(0.006, 0, 0); // what is fastest now was not, and is elsewhere: within what explicit steps keep from the bound
    const double anew = fastest(problem, x).step();
    fastest(problem, x, &motions);
    CHECK(fastest(problem, x, &motions).step() == Approx(anew).epsilon(0.03));
}

TEST_CASE("springs: damping shortens the steps that explicit springs bear", "[springs]") {
    // With k_d = t k_s, w^2 h^2 + 2 t w^2 h = 4.
    const double w = 2 / 584.7e-6;
    for (const double time : {1e-4, 1e-3}) {
        std::vector<Spring> springs = equal_springs(500);
        damp(springs, time);
        FreeCloth problem(std::make_unique<Springs>(springs), equal_mass);
        const double limit = -time + std::sqrt(time * time + 4 / (w * w));
        CHECK(fastest(problem, grid_points(sheet)).step() == Approx(limit).epsilon(0.005));
        CHECK(!blows_up(springs, 0.98 * limit));
        CHECK(blows_up(springs, 1.02 * limit));
    }
}

TEST_CASE("springs: explicit steps never exceed by themselves what is stable, and say when they were told to", "[springs]") {
    Fabric f = plain_fabric(100, 1e-5);
    const FlatMesh mesh = jittered_rectangle(0.2, 0.2, 0.025, 0.25, 7);
    const Garment garment = garment_of(mesh);
    SpringMeshOptions how;
    how.damping_time = 2e-5;
    how.beyond = 10;
    f.limit_warp = f.limit_weft = f.limit_shear = 0.02;
    const std::vector<Spring> springs = mesh_springs(garment, {f}, how);
    FreeSprings<ExplicitStepper> s(springs, std::vector<double>(mesh.points.size(), 1e-4), flat_points(mesh), 2e-3);
    s.problem.gravity = 9.81;
    s.problem.pin(0);
    bool was_stiff = false;
    for (int i = 0; i < 100; ++i) {
        s.step();
        const double substep = 2e-3 / s.stepper.substeps();
        bool changed = false;
        const Eigen::MatrixXd k = dense(s.problem.hessian(s.cloth.x, true, changed));
        BlockMatrix damping = full_matrix(s.problem.points());
        s.problem.add_damping_matrix(s.cloth.x, 1, damping);
        const Eigen::MatrixXd all = (substep * substep * k + 2 * substep * dense(damping)) / 1e-4;
        const Eigen::MatrixXd free = all.bottomRightCorner(all.rows() - 3, all.cols() - 3); // the first node is pinned
        CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(free, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff() < 4);
        for (const Spring& spring : springs)
            was_stiff = was_stiff || (s.cloth.x[spring.b] - s.cloth.x[spring.a]).norm() > spring.length + spring.threshold;
    }
    CHECK(was_stiff); // or the bound had nothing to follow
    s.stepper.substep = 1e-3;
    s.stepper.options().max_motion = 0.01;
    const RestResult r = come_to_rest(s.stepper, s.cloth, {}, {});
    CHECK(!r.rested);
    CHECK_THAT(r.broken, Catch::Contains("blew up"));
    for (const Vec3& p : s.cloth.x) CHECK(p.allFinite());
}

TEST_CASE("springs: waves, chains and cantilevers swing as theory says", "[springs]") {
    const auto run = [](auto stepper) {
        using S = typename decltype(stepper)::type;
        SECTION("wave") { // along a strip that may not narrow, between fixed ends: period 2 L / c, c^2 = k / rho
            const SpringGrid strip{41, 2, 0.02};
            const double c = std::sqrt(1000 / 0.2), length = 0.8, period = 2 * length / c, dt = share_of_period<S> * period;
            Points x = grid_points(strip);
            for (Vec3& p : x) p.x() += 1e-4 * std::sin(pi * p.x() / length);
            FreeSprings<S> s(grid_springs(strip, {1000, 1000, 0, 0, 0}, Diagonals::one), grid_masses(strip, 0.2), x, dt);
            for (int i : {0, 40, 41, 81}) s.problem.pin(i);
            const double w = swing(dt, [&] { return s.cloth.x[20].x() - 0.4; }, [&] { s.step(); });
            CHECK(w * length / pi == Approx(c).epsilon(0.02)); // speed
        }
        SECTION("hanging chain") { // J_0(2 w sqrt(L / g)) = 0
            const int links = 40;
            const double length = 1, link = length / links, w = 0.5 * 2.404825558 * std::sqrt(9.81 / length);
            std::vector<Spring> springs;
            std::vector<double> mass;
            Points x;
            const double per_metre = 0.05, stiffness = 4e4;
            double below = 0; // weight, which stretches what it hangs by
            std::vector<double> pull(links);
            for (int i = links; i >= 1; --i) {
                below += 9.81 * per_metre * link * (i == links ? 0.5 : 1);
                pull[i - 1] = below;
            }
            double y = 0;
            for (int i = 0; i <= links; ++i) {
                const double below_end = length + y;
                // Bending of the lowest mode, J_0(2 w sqrt(s / g)) with s from the free end.
                x.push_back({1e-3 * std::cyl_bessel_j(0, 2 * w * std::sqrt(std::max(0.0, below_end) / 9.81)), y, 0});
                mass.push_back(per_metre * link * (i == 0 || i == links ? 0.5 : 1));
                if (i == links) break;
                Spring s{i, i + 1, link};
                s.stiffness = stiffness;
                springs.push_back(s);
                y -= link + pull[i] / stiffness;
            }
            x[0] = {0, 0, 0};
            const double dt = share_of_period<S> * 2 * pi / w / (share_of_period<S> < 1e-3 ? 1 : 8);
            FreeSprings<S> s(springs, mass, x, dt);
            s.problem.gravity = 9.81;
            s.problem.pin(0);
            CHECK(swing(dt, [&] { return s.cloth.x[links].x(); }, [&] { s.step(); }) == Approx(w).epsilon(0.02));
        }
        SECTION("cantilever") { // w = 1.8751^2 sqrt(B / (rho L^4))
            // A node stands for the curvature of half an edge to either side: the clamp ends in the middle of the edge held.
            const SpringGrid strip{22, 2, 0.01};
            const double bend = 1e-4, length = 0.205, w = 3.51602 * std::sqrt(bend / (0.2 * std::pow(length, 4)));
            Points x = grid_points(strip);
            for (Vec3& p : x) {
                const double s = std::max(0.0, p.x() - 0.005) / length, b = 1.8751040687;
                const double ratio = (std::cosh(b) + std::cos(b)) / (std::sinh(b) + std::sin(b));
                p.z() = 2e-4 * (std::cosh(b * s) - std::cos(b * s) - ratio * (std::sinh(b * s) - std::sin(b * s)));
            }
            const double dt = share_of_period<S> * 2 * pi / w;
            for (int i : {0, 1, 22, 23}) x[i].z() = 0;
            FreeSprings<S> s(grid_springs(strip, {200, 200, 50, 0, bend}, Diagonals::both), grid_masses(strip, 0.2), x, dt);
            for (int i : {0, 1, 22, 23}) s.problem.pin(i);
            CHECK(swing(dt, [&] { return s.cloth.x[21].z(); }, [&] { s.step(); }) == Approx(w).epsilon(0.02));
        }
    };
    SECTION("explicit") { run(std::type_identity<ExplicitStepper>()); }
    SECTION("implicit") { run(std::type_identity<ImplicitStepper>()); }
}

TEST_CASE("springs: energy and momentum are what the integrator keeps", "[springs]") {
    const auto shaken = [] {
        Points x = grid_points(sheet);
        Random random(5);
        for (Vec3& p : x) p = Vec3(1.01 * p.x(), p.y(), 1e-3 * std::sin(9 * p.x())) + random.vec3(1e-4);
        return x;
    };
    const auto springs = grid_springs(sheet, {500, 500, 100, 1e-4, 1e-4}, Diagonals::both);
    const std::vector<double> mass = grid_masses(sheet, 0.2);
    const auto momentum = [&](const Moving& c) {
        std::pair<Vec3, Vec3> sum{Vec3::Zero(), Vec3::Zero()};
        for (std::size_t i = 0; i < mass.size(); ++i) {
            sum.first += mass[i] * c.velocity[i];
            sum.second += mass[i] * c.x[i].cross(c.velocity[i]);
        }
        return sum;
    };
    SECTION("explicit: bounded over ten thousand steps, momentum and spin to the last digits") {
        // What symplectic Euler keeps is H - h/2 v.K x, off H by up to w h / 2: 0.23 of the fastest motion here.
        FreeSprings<ExplicitStepper> s(springs, mass, shaken(), 2e-3);
        s.stepper.substep = 0.25 * s.stepper.stable_substep(s.cloth.x);
        for (std::size_t i = 0; i < mass.size(); ++i) s.cloth.velocity[i] = Vec3(0.1, 0, 0) + Vec3(0, 0, 1).cross(s.cloth.x[i]);
        const double start = s.energy();
        const auto before = momentum(s.cloth);
        double least = start, most = start;
        int substeps = 0;
        while (substeps < 10000) {
            s.step();
            substeps += s.stepper.substeps();
            least = std::min(least, s.energy());
            most = std::max(most, s.energy());
        }
        CHECK(most < 1.05 * start);
        CHECK(least > 0.95 * start);
        CHECK((momentum(s.cloth).first - before.first).norm() < 1e-10 * before.first.norm());
        CHECK((momentum(s.cloth).second - before.second).norm() < 1e-9 * before.second.norm());
    }
    SECTION("implicit: decays in every step, momentum stays") {
        FreeSprings<ImplicitStepper> s(springs, mass, shaken(), 2e-3);
        for (Vec3& v : s.cloth.velocity) v = Vec3(0.1, 0, 0);
        const auto before = momentum(s.cloth);
        const double start = s.energy(), moving = 0.5 * 0.05 * 0.01;
        double last = start;
        for (int i = 0; i < 200; ++i) {
            s.step();
            CHECK(s.energy() <= last * (1 + 1e-9));
            last = s.energy();
        }
        CHECK(last - moving < 0.2 * (start - moving));
        CHECK((momentum(s.cloth).first - before.first).norm() < 1e-9 * before.first.norm());
    }
}

TEST_CASE("springs: limits hold their springs, and the order of the sweep tells", "[springs]") {
    // A square sheet of soft springs hung by its upper corners.
    std::vector<Spring> springs = grid_springs(sheet, {20, 20, 5, 0, 0}, Diagonals::both);
    damp(springs, 1e-3);
    for (Spring& s : springs) s.limit = 0.05;
    const auto longest = [&](const Points& x, bool shear) {
        double most = 0;
        for (const Spring& s : springs)
            if ((s.kind == SpringKind::shear) == shear) most = std::max(most, (x[s.b] - x[s.a]).norm() / s.length - 1);
        return most;
    };
    const auto hang = [&](const LimitOptions& limits) {
        auto problem = std::make_unique<FreeCloth>(std::make_unique<Springs>(springs), grid_masses(sheet, 0.2));
        problem->gravity = 9.81;
        problem->pin(110);
        problem->pin(120);
        NoContact response;
        LimitedStepper stepper(std::move(problem), springs, response, {2e-3, 5, 1e9}, limits);
        Moving cloth{grid_points(sheet)};
        for (int i = 0; i < 400; ++i) stepper.step(cloth, {});
        return cloth.x;
    };
    LimitOptions none;
    none.sweeps = 0;
    const Points loose = hang(none), stretch = hang({false, SweepOrder::listed, 5});
    CHECK(longest(loose, false) > 0.2);
    CHECK(longest(stretch, false) < 0.075);
    CHECK(longest(stretch, true) > 0.1);
    const Points both = hang({true, SweepOrder::listed, 5});
    CHECK(longest(both, false) < 0.08);
    CHECK(longest(both, true) < 0.08);
    // One sweep: what comes last has its way, and the errors are left elsewhere.
    std::vector<double> left;
    for (const SweepOrder order :
         {SweepOrder::listed, SweepOrder::reversed, SweepOrder::longest_first, SweepOrder::from_top})
        left.push_back(longest(hang({false, order, 1}), false));
    for (const double l : left) CHECK(l < 0.12);
    CHECK(*std::max_element(left.begin(), left.end()) > 1.05 * *std::min_element(left.begin(), left.end()));
}
