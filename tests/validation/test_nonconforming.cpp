// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth that keeps its lengths exactly, against known answers. docs/nonconforming.md has the figures on more
// meshes.

#include "draping/energy/bend.h"
#include "draping/nonconforming/motion.h"

#include "tests/support/midpoint_strip.h"
#include "tests/support/sewn_sector.h"

#include <catch2/catch.hpp>

#include <complex>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double pi = std::numbers::pi;
const std::vector<MeshKind> kinds = {MeshKind::aligned, MeshKind::alternating, MeshKind::unstructured};

/// Drop over reach at gamma = 10 with a point per node and every edge of the mesh as a bar; both arms of a
/// strip that is clamped by symmetry.
double conforming_slope(const FlatMesh& arm) {
    const FlatMesh mesh = with_mirror_image(arm);
    const Garment garment = garment_of(mesh);
    IsometricProblem problem;
    problem.stiffness = make_bending(garment, {sheet_fabric(1, 1)}).stiffness;
    problem.held.assign(garment.node_count, 0);
    problem.load.assign(garment.node_count, Vec3::Zero());
    for (const auto& [a, b] : garment.edges.ends)
        problem.bars.push_back({a, b, (mesh.points[a] - mesh.points[b]).norm()});
    for (int t = 0; t < int(garment.triangles.size()); ++t)
        for (int node : garment.nodes(t))
            problem.load[node].z() -= 10 * std::abs(garment.rest.edges[t].determinant()) / 6;
    for (int i = 0; i < garment.node_count; ++i)
        problem.held[i] = std::abs(mesh.points[i].x()) < 1e-12;
    Points x = flat_points(mesh);
    Saddle saddle(problem.stiffness, problem.bars, problem.held);
    IsometricOptions options;
    options.tolerance = 1e-6 * 10 * 0.5 / garment.node_count;
    options.strain = 1e-6; // as much as is allowed to cloth on midpoints
    options.max_iterations = 60;
    settle_isometric(saddle, problem, x, options);
    CHECK(largest_strain(problem.bars, x) < 1e-6);
    double reach = 0, drop = 0;
    for (int i = 0; i < garment.node_count; ++i)
        if (mesh.points[i].x() > 1 - 1e-9) reach += x[i].x(), drop -= x[i].z();
    return drop / reach;
}

/// A strip of 30 by 10 cm, pinned by ghost nodes at one end, level.
Motion swinging_strip(bool pinned) {
    const FlatMesh mesh = strip_mesh(MeshKind::unstructured, 0.3, 0.1, 12, 4);
    const Garment garment = garment_of(mesh);
    std::vector<GhostSpring> pins;
    for (int i = 0; pinned && i < garment.node_count; ++i)
        if (mesh.points[i].x() < 1e-9) pins.push_back({i, flat_points(mesh)[i], 100});
    return start_motion(make_nonconforming_cloth(garment, {sheet_fabric(0.15, 1e-4)}), garment,
                        flat_points(mesh), {{}, {}, pins});
}

Points after_swing(double seconds, int steps) {
    Motion motion = swinging_strip(true);
    REQUIRE(motion.isometric);
    MotionOptions options;
    options.time_step = seconds / steps;
    for (int i = 1; i <= steps; ++i) {
        // Weight that comes and goes gently leaves no short waves, which no time step would resolve.
        const double weight = 9.81 * (1 - std::cos(2 * pi * i / steps)) / 2;
        REQUIRE(try_step(motion, Vec3(0, 0, -weight), {}, options).end == IsometricEnd::settled);
        finish_step(motion, options);
    }
    CHECK(largest_strain(motion.cloth.bars, motion.x) < 1e-8);
    return ghost_nodes(motion.cloth.midpoints, motion.x);
}

double farthest(const Points& a, const Points& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        most = std::max(most, (a[i] - b[i]).norm());
    return most;
}

/// Thrown, spinning and bent, without gravity.
Motion thrown_strip() {
    Motion motion = swinging_strip(false);
    const Points shape = motion.x;
    for (std::size_t i = 0; i < shape.size(); ++i) {
        // A bulge that begins without moment or shear at the free ends.
        const double bulge = 0.5 * std::pow(std::sin(pi * shape[i].x() / 0.3), 4);
        motion.velocity[i] = Vec3(1, 2, 0.5 + 5 * (shape[i].x() - 0.15) + bulge);
    }
    return motion;
}

/// By how much kinetic and bending energy change in flight from 0.02 to 0.1 s.
double energy_change(double time_step) {
    Motion motion = thrown_strip();
    MotionOptions options;
    options.time_step = time_step;
    const auto fly = [&](double seconds) {
        for (int i = 0; i < std::lround(seconds / time_step); ++i) {
            REQUIRE(try_step(motion, Vec3::Zero(), {}, options).end == IsometricEnd::settled);
            finish_step(motion, options);
        }
        return kinetic_energy(motion) + bend_value(motion.cloth.bending, motion.x);
    };
    const double early = fly(0.02);
    return fly(0.08) - early;
}

} // namespace

TEST_CASE("cloth on midpoints hangs as the elastica does", "[validation][nonconforming]") {
    for (const auto& [gamma, slope] :
         {std::pair{1.0, 0.12456176644}, {10.0, 1.06680232}, {100.0, 5.8881046}}) {
        std::vector<double> slopes;
        for (MeshKind kind : kinds) {
            INFO("gamma " << gamma << ", mesh " << int(kind));
            const Cantilever c = hang(strip_mesh(kind, 1, 0.25, 28), gamma);
            CHECK(c.result.end == IsometricEnd::settled);
            CHECK(c.stable);
            CHECK(c.strain < 1e-6);
            CHECK(c.drop_over_reach == Approx(slope).epsilon(0.02));
            slopes.push_back(c.drop_over_reach);
        }
        const auto [low, high] = std::minmax_element(slopes.begin(), slopes.end());
        CHECK(*high - *low < 0.01 * slope);
    }
}

TEST_CASE("its error falls with the square of the edge", "[validation][nonconforming]") {
    for (MeshKind kind : kinds) {
        const double coarse = hang(strip_mesh(kind, 1, 0.25, 12), 10).drop_over_reach / 1.06680232 - 1;
        const double fine = hang(strip_mesh(kind, 1, 0.25, 24), 10).drop_over_reach / 1.06680232 - 1;
        INFO("mesh " << int(kind) << ": " << coarse << ", " << fine);
        CHECK(std::abs(coarse) < 0.02);
        CHECK(std::abs(fine) < 0.35 * std::abs(coarse));
    }
}

TEST_CASE("the nodes of a mesh with edges that keep their lengths lock", "[validation][nonconforming]") {
    // A strip rolls about lines of the mesh that run straight across it, where there are any.
    CHECK(conforming_slope(strip_mesh(MeshKind::aligned, 1, 0.25, 20)) == Approx(1.06680232).epsilon(0.02));
    CHECK(conforming_slope(strip_mesh(MeshKind::unstructured, 1, 0.25, 20)) < 0.1 * 1.06680232);
    CHECK(conforming_slope(jittered_rectangle(1, 0.25, 0.05, 0, 1)) <
          0.1 * 1.06680232); // equilateral triangles
}

TEST_CASE("a sewn sector of cloth on midpoints is a cone", "[validation][nonconforming]") {
    const double half_angle = 48.59037789, energy = 1.83259571; // a deficit of 90 degrees
    for (std::uint64_t seed : {3, 4}) {
        const Sector s = sewn_sector(1.5 * pi, seed, 0.1);
        const NonconformingCloth cloth = make_nonconforming_cloth(s.garment, {sheet_fabric(0.15, 1e-5)});
        const IsometricProblem problem = problem_of(cloth, Vec3::Zero());
        Saddle saddle(problem.stiffness, problem.bars, problem.held);
        Points x = midpoints_of(s.garment, rough_cone(s, 1.5 * pi, half_angle + 4));
        CHECK(largest_triangle_strain(s.garment, x) > 0.01);
        REQUIRE(make_isometric(saddle, problem, x));
        CHECK(largest_triangle_strain(s.garment, x) < 1e-6);
        IsometricOptions options;
        options.tolerance = 1e-9; // of bending forces around 1e-4 N
        const IsometricResult r = settle_isometric(saddle, problem, x, options);
        REQUIRE(r.end == IsometricEnd::settled);
        CHECK(largest_triangle_strain(s.garment, x) < 1e-6);
        const std::vector<double> angles = generator_angles(s, ghost_nodes(cloth.midpoints, x));
        REQUIRE(!angles.empty());
        for (double a : angles)
            CHECK(a == Approx(half_angle).margin(0.3));
        CHECK(bend_value(cloth.bending, x) ==
              Approx(1e-5 * energy * std::log(Sector::outer / Sector::inner)).epsilon(0.03));
    }
}

TEST_CASE("a swinging strip is followed to second order in time", "[validation][nonconforming]") {
    const Points a = after_swing(0.2, 40), b = after_swing(0.2, 80), c = after_swing(0.2, 160);
    const double order = std::log2(farthest(a, b) / farthest(b, c));
    INFO(farthest(a, b) << " m, " << farthest(b, c) << " m");
    CHECK(farthest(b, c) < 1e-4);
    CHECK(order > 1.7);
    CHECK(order < 2.5);
}

TEST_CASE("free flight keeps momentum to round-off and energy to second order",
          "[validation][nonconforming]") {
    Motion motion = thrown_strip();
    const Vec3 before = momentum(motion);
    MotionOptions options;
    options.time_step = 1e-3;
    for (int i = 0; i < 50; ++i) {
        REQUIRE(try_step(motion, Vec3::Zero(), {}, options).end == IsometricEnd::settled);
        finish_step(motion, options);
        CHECK((momentum(motion) - before).norm() < 1e-11 * before.norm());
    }
    const double coarse = energy_change(2e-3), fine = energy_change(1e-3);
    INFO(coarse << ", " << fine << " J of " << kinetic_energy(motion));
    CHECK(std::abs(fine) < 1e-5 * kinetic_energy(motion));
    CHECK(std::log2(coarse / fine) > 1.7);
}

TEST_CASE("a pendulum loses energy as the amplification of BDF2 says", "[validation][nonconforming]") {
    // A stiff plate that hangs by one edge is a pendulum of omega^2 = 3 g / 2 L.
    const double length = 0.3, omega = std::sqrt(1.5 * 9.81 / length), angle = 0.02;
    const FlatMesh mesh = strip_mesh(MeshKind::unstructured, length, 0.1, 8, 4);
    const Garment garment = garment_of(mesh);
    std::vector<char> held(garment.edges.size(), 0);
    for (int e : edges_at_wall(mesh, garment))
        held[e] = 1;
    Points nodes;
    for (const Vec2& p : mesh.points)
        nodes.push_back({p.x() * std::sin(angle), p.y(), -p.x() * std::cos(angle)});
    Motion motion;
    const auto energy = [&] {
        double potential = 0, mass = 0;
        for (std::size_t i = 0; i < motion.x.size(); ++i) {
            potential += 9.81 * motion.cloth.midpoints.mass[i] * motion.x[i].z();
            mass += motion.cloth.midpoints.mass[i];
        }
        return kinetic_energy(motion) + potential + 9.81 * mass * length / 2 +
               bend_value(motion.cloth.bending, motion.x);
    };
    for (double step : {0.2, 0.3}) { // times 1 / omega
        motion =
            start_motion(make_nonconforming_cloth(garment, {sheet_fabric(0.15, 1)}), garment, nodes, {held, {}, {}});
        MotionOptions options;
        options.time_step = step / omega;
        const auto swing = [&](int steps) {
            for (int i = 0; i < steps; ++i) {
                REQUIRE(try_step(motion, Vec3(0, 0, -9.81), {}, options).end == IsometricEnd::settled);
                finish_step(motion, options);
            }
            return energy();
        };
        const double early = swing(10), late = swing(60);
        const std::complex<double> z(0, step);
        const double kept = std::pow(std::abs((2.0 + std::sqrt(1.0 + 2.0 * z)) / (3.0 - 2.0 * z)), 2 * 60);
        INFO("kept " << late / early << ", by theory " << kept);
        CHECK(1 - late / early == Approx(1 - kept).epsilon(0.02));
    }
}

TEST_CASE("ghost nodes go where contact puts them", "[validation][nonconforming]") {
    // A strip falls flat on a floor: velocities of ghost nodes that would go below it are cut.
    Motion motion = swinging_strip(false);
    MotionOptions options;
    options.time_step = 2e-3;
    const double floor = -0.01;
    Points nodes = ghost_nodes(motion.cloth.midpoints, motion.x);
    for (int i = 0; i < 100; ++i) {
        MotionStep step = try_step(motion, Vec3(0, 0, -9.81), {}, options);
        REQUIRE(step.end == IsometricEnd::settled);
        Points expected = nodes;
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            double& v = step.ghost_velocity[k].z();
            v = std::max(v, (floor - nodes[k].z()) / options.time_step);
            expected[k] += options.time_step * step.ghost_velocity[k];
        }
        finish_step(motion, options, step.ghost_velocity);
        nodes = ghost_nodes(motion.cloth.midpoints, motion.x);
        CHECK(farthest(nodes, expected) < 1e-12);
    }
    CHECK_THROWS_WITH(finish_step(motion, options, Points(3)), Catch::Contains("are of 3 nodes, expected"));
    // Each step ends with a correction that the next one makes good: weight acts on midpoints, the floor on
    // nodes.
    CHECK(largest_strain(motion.cloth.bars, motion.x) < 5e-5);
    CHECK(kinetic_energy(motion) < 1e-6);
    for (const Vec3& p : nodes)
        CHECK(p.z() == Approx(floor).margin(1e-9));
}
