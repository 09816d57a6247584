// SPDX-License-Identifier: GPL-3.0-or-later
// How fast waves run and strips swing, for every method that moves: docs/waves.md. With -s the figures are shown.

#include "draping/cloth.h"
#include "draping/method.h"
#include "draping/solve/implicit.h"
#include "draping/stability/beam.h"
#include "tests/support/free_springs.h"
#include "tests/support/midpoint_strip.h"
#include "tests/support/plates.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace toile;
using namespace toile::test;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double g = 9.81;

/// A strip that is let go from `shape` beside its rest.
struct Scene {
    FlatMesh mesh;
    Fabric fabric;
    double frequency = 0; ///< rad/s, of a mode of that shape, by theory
    Points rest = {}, shape = {};
    std::vector<char> pinned = {};
    Loads loads = {};
};

/// 0.15 kg/m2, alike both ways. Its limits are beyond what moves here.
Fabric cloth(double stretch, double shear, double bend) {
    Fabric f = sheet_fabric(0.15, bend);
    f.stretch_warp = f.stretch_weft = stretch;
    f.shear = shear;
    f.compression = 1;
    f.limit_warp = f.limit_weft = f.limit_shear = 0.1;
    return f;
}

/// One row of squares.
FlatMesh row(double length, int columns) { return strip_mesh(MeshKind::alternating, length, length / columns, columns); }

/// `place` takes where a node of the flat strip is to where it rests and how far it is off that at first.
template <class Place>
Scene scene(FlatMesh mesh, const Fabric& fabric, double frequency, const Place& place) {
    Scene s{std::move(mesh), fabric, frequency};
    for (const Vec2& p : s.mesh.points) {
        const auto [rest, shape] = place(p);
        s.rest.push_back(rest);
        s.shape.push_back(shape);
        s.pinned.push_back(std::abs(p.x()) < 1e-9);
    }
    return s;
}

/// Waves of stretch between two ends: half a wave, c^2 = k / rho.
Scene stretch_wave() {
    const double length = 0.8, stretch = 1000;
    const Fabric fabric = cloth(stretch, 10, 1e-6);
    Scene s = scene(row(length, 40), fabric, pi / length * std::sqrt(stretch / fabric.density), [&](const Vec2& p) {
        return std::pair(Vec3(p.x(), p.y(), 0), Vec3(1e-4 * std::sin(pi * p.x() / length), 0, 0));
    });
    for (std::size_t i = 0; i < s.rest.size(); ++i)
        if (s.rest[i].x() > length - 1e-9) s.pinned[i] = 1;
    return s;
}

/// Cloth on edge midpoints of a single row of triangles hangs together along its middle line, about which triangles turn
/// freely unless they are bound to each other by more bending than a string ought to have.
double little_bending(Method m) { return m == Method::nonconforming ? 1e-4 : 1e-8; }

/// A strip that hangs from its upper end under a tension (N/m) by the length above, off plumb by `shape` of that.
template <class Shape, class Tension>
Scene hung(Method method, double length, double frequency, const Shape& shape, const Tension& tension) {
    const int columns = 20;
    const double edge = length / columns;
    const bool lengthens = method != Method::inextensible && method != Method::nonconforming;
    const Fabric fabric = cloth(1000, 10, little_bending(method));
    std::vector<double> y{0};
    for (int k = 0; k < columns; ++k) {
        const double strain = lengthens ? tension((k + 0.5) * edge) / fabric.stretch_weft : 0;
        y.push_back(y.back() - std::sqrt(std::pow((1 + strain) * edge, 2) - std::pow(shape((k + 1) * edge) - shape(k * edge), 2)));
    }
    return scene(row(length, columns), fabric, frequency, [&](const Vec2& p) {
        return std::pair(Vec3(p.y(), y[std::lround(p.x() / edge)], 0), Vec3(0, 0, shape(p.x())));
    });
}

/// Waves across a strip that is pulled at its lower end: a quarter of a wave, c^2 = T / rho.
Scene string(Method method) {
    const double length = 0.5, tension = 1;
    Scene s = hung(method, length, pi / (2 * length) * std::sqrt(tension / 0.15),
                   [&](double at) { return 1e-3 * std::sin(0.5 * pi * at / length); }, [&](double) { return tension; });
    for (std::size_t i = 0; i < s.rest.size(); ++i) // a hook that is far away pulls by its cap
        if (s.mesh.points[i].x() > length - 1e-9)
            s.loads.hooks.push_back({int(i), s.rest[i] - Vec3(0, 1, 0), Vec3(0, 1, 0), 1e3, 0.5 * tension * s.mesh.points.back().y()});
    return s;
}

/// J_0(2 w sqrt(s / g)), s from the free end, which is 0 where it hangs.
Scene chain(Method method) {
    const double length = 1, w = 0.5 * 2.404825558 * std::sqrt(g / length);
    Scene s = hung(method, length, w,
                   [&](double at) { return 1e-3 * std::cyl_bessel_j(0, 2 * w * std::sqrt(std::max(0.0, length - at) / g)); },
                   [&](double at) { return 0.15 * g * (length - at); });
    s.loads.gravity = g;
    return s;
}

constexpr double beam_length = 0.2;

/// Both arms of a strip that is clamped in its middle: w = 1.8751^2 sqrt(B / (rho L^4)).
Scene cantilever(const FlatMesh& half, double stretch) {
    const Fabric fabric = cloth(stretch, stretch / 2, 1e-3);
    const double w = beam_root * beam_root * std::sqrt(fabric.bend_weft / (fabric.density * std::pow(beam_length, 4)));
    return scene(with_mirror_image(half), fabric, w, [&](const Vec2& p) {
        return std::pair(Vec3(p.x(), p.y(), 0), Vec3(0, 0, 1e-4 * beam_mode(std::abs(p.x()) / beam_length)));
    });
}

/// Of one row of cells that are `slender` times as long as wide.
FlatMesh cells(double slender, int columns = 20) {
    return strip_mesh(MeshKind::alternating, beam_length, beam_length / (columns * slender), columns);
}

/// A strip in motion.
struct Swinging {
    const Scene& scene;
    Garment garment = garment_of(scene.mesh);
    std::vector<Fabric> fabrics{scene.fabric};
    NoContact response;
    std::unique_ptr<ClothProblem> sheet; ///< of equilibrium, which swings as `--animate` has it
    std::unique_ptr<Stepper> stepper;
    Moving cloth{scene.rest};

    Swinging(const Scene& s, Method method, double dt) : scene(s) {
        const StepOptions step{dt, 0, 1e9};
        MethodOptions how;
        if (method == Method::inextensible) how.time_step = dt;
        if (method == Method::equilibrium) {
            sheet = std::make_unique<ClothProblem>(garment, fabrics, TriMesh{}, ContactOptions{{1, 0, 0}, {1, 0, 0}, false});
            for (int i = 0; i < sheet->points(); ++i)
                if (s.pinned[i]) sheet->pin(i);
            stepper = std::make_unique<ImplicitStepper>(*sheet, response, step);
        } else {
            stepper = make_stepper(method, garment, fabrics, s.pinned, response, step, how);
        }
        stepper->loads() = s.loads;
        for (std::size_t i = 0; i < s.rest.size(); ++i) cloth.x[i] += s.shape[i];
        cloth.velocity.assign(s.rest.size(), Vec3::Zero());
    }
    /// How much of the shape is left.
    double amplitude() const {
        double sum = 0, all = 0;
        for (std::size_t i = 0; i < scene.rest.size(); ++i) {
            sum += stepper->node_mass()[i] * (cloth.x[i] - scene.rest[i]).dot(scene.shape[i]);
            all += stepper->node_mass()[i] * scene.shape[i].squaredNorm();
        }
        return sum / all;
    }
};

/// Frequency (rad/s) by the first two crossings of zero downwards.
double frequency(const Scene& s, Method method, int steps_a_period = 400) {
    const double dt = 2 * pi / s.frequency / steps_a_period;
    Swinging strip(s, method, dt);
    std::vector<double> crossings;
    double last = strip.amplitude();
    for (int i = 1; crossings.size() < 2 && i < 2 * steps_a_period; ++i) {
        strip.stepper->step(strip.cloth, {});
        const double now = strip.amplitude();
        if (last > 0 && now <= 0) crossings.push_back((i - 1 + last / (last - now)) * dt);
        last = now;
    }
    REQUIRE(crossings.size() == 2);
    return 2 * pi / (crossings[1] - crossings[0]);
}

constexpr std::array springs{Method::springs_explicit, Method::springs_implicit, Method::springs_biphasic, Method::springs_limited};

/// Local and global steps, ten in each step, get the nearer the less there is to go.
int steps_for_a_string(Method m) { return m == Method::projective ? 2000 : 400; }

/// Share of a plate's stiffness that hinges in one row of cells with alternating diagonals have, s the length over the
/// width of a cell. The hinge of a cross edge feels the curvature of one rail there, of the upper and the lower one in
/// turn. Rails curved by 1 - e where it is felt and by 1 + e where it is not turn the diagonals by e (1 + s^2):
/// the least of (1 - e)^2 + e^2 (1 + s^2)^2.
double hinge_stiffness(double s) {
    const double turned = std::pow(1 + s * s, 2);
    return turned / (1 + turned);
}

} // namespace

TEST_CASE("waves: stretch runs as fast as stiffness and weight say", "[waves]") {
    const Scene s = stretch_wave();
    for (const Method m : all_methods()) {
        if (m == Method::inextensible || m == Method::nonconforming) continue; // nothing stretches
        INFO(to_string(m) << ", rad/s");
        CHECK(frequency(s, m) == Approx(s.frequency).epsilon(0.01));
    }
}

TEST_CASE("waves: across a strip they run as fast as its tension and weight say", "[waves]") {
    for (const Method m : all_methods()) {
        INFO(to_string(m) << ", rad/s");
        const Scene s = string(m);
        CHECK(frequency(s, m, steps_for_a_string(m)) == Approx(s.frequency).epsilon(0.01));
    }
}

TEST_CASE("waves: a hanging strip swings as a chain does", "[waves]") {
    for (const Method m : all_methods()) {
        INFO(to_string(m) << ", rad/s");
        const Scene s = chain(m);
        CHECK(frequency(s, m, steps_for_a_string(m)) == Approx(s.frequency).epsilon(0.01));
    }
}

TEST_CASE("waves: cloth that bends as a plate swings as a cantilever", "[waves]") {
    const Scene wide = cantilever(strip_mesh(MeshKind::alternating, beam_length, beam_length / 4, 20), 10);
    for (const Method m : {Method::equilibrium, Method::projective, Method::inextensible}) {
        INFO(to_string(m) << ", rad/s");
        CHECK(frequency(wide, m) == Approx(wide.frequency).epsilon(0.01));
    }
    for (const int seed : {1, 3}) {
        const Scene uneven = cantilever(strip_mesh(MeshKind::unstructured, beam_length, beam_length / 4, 20, seed), 10);
        for (const Method m : {Method::equilibrium, Method::projective}) {
            INFO(to_string(m) << ", rad/s, unstructured mesh " << seed);
            CHECK(frequency(uneven, m) == Approx(uneven.frequency).epsilon(0.01));
        }
    }
    const Scene narrow = cantilever(cells(1, 12), 10);
    INFO("nonconforming, rad/s");
    CHECK(frequency(narrow, Method::nonconforming, 100) == Approx(narrow.frequency).epsilon(0.01));
}

TEST_CASE("waves: hinges swing as a cantilever where no diagonal is in the way, and as slowly as theirs make them", "[waves]") {
    for (const double slender : {0.75, 1.0, 3.0}) {
        const double share = std::sqrt(hinge_stiffness(slender));
        CHECK((share > 0.99) == (slender == 3)); // what a plate does is within 1 %
        const Scene s = cantilever(cells(slender), 1000);
        INFO("cells " << slender << " times as long as wide");
        for (const Method m : springs) {
            INFO(to_string(m) << ", rad/s");
            CHECK(frequency(s, m) == Approx(share * s.frequency).epsilon(0.01));
        }
        INFO("triangles, rad/s");
        CHECK(frequency(s, Method::triangles) == Approx(share * s.frequency).epsilon(0.01));
    }
    // Hinges of all directions average out, more or less.
    for (const int seed : {1, 2, 3}) {
        const Scene s = cantilever(strip_mesh(MeshKind::unstructured, beam_length, beam_length / 4, 20, seed), 100);
        INFO("triangles, rad/s, unstructured mesh " << seed);
        CHECK(frequency(s, Method::triangles) == Approx(s.frequency).epsilon(0.05));
    }
    // Sweeps do not bear as much: a tenth of the stretch, and shorter steps for narrow cells.
    for (const double slender : {1.0, 3.0}) {
        const Scene s = cantilever(cells(slender), 100);
        INFO("xpbd, rad/s, cells " << slender << " times as long as wide");
        CHECK(frequency(s, Method::xpbd, slender == 3 ? 2000 : 400) ==
              Approx(std::sqrt(hinge_stiffness(slender)) * s.frequency).epsilon(0.01));
    }
}

TEST_CASE("waves: below what they limit, limited springs move as those without limits", "[waves]") {
    const Scene s = chain(Method::springs_implicit);
    CHECK(frequency(s, Method::springs_biphasic) == frequency(s, Method::springs_implicit));
    CHECK(frequency(s, Method::springs_limited) == frequency(s, Method::springs_explicit));
    // A fabric that gives by less than the strip's weight stretches it.
    Scene tight = s;
    tight.fabric.limit_warp = tight.fabric.limit_weft = tight.fabric.limit_shear = 5e-4;
    CHECK(frequency(tight, Method::springs_biphasic) != frequency(s, Method::springs_implicit));
    CHECK(frequency(tight, Method::springs_limited) != frequency(s, Method::springs_explicit));
}
