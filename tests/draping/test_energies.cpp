// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/cloth.h"
#include "draping/contact/contact.h"
#include "draping/contact/friction.h"
#include "draping/energy/bend.h"
#include "draping/energy/elastic.h"
#include "draping/energy/projective.h"
#include "draping/energy/rest_curvature.h"
#include "draping/energy/spring.h"
#include "draping/energy/spring_grid.h"
#include "draping/energy/spring_mesh.h"
#include "draping/energy/stretch.h"
#include "draping/energy/triangles.h"
#include "draping/energy/yarns.h"

#include "tests/support/curved_cloth.h"
#include "tests/support/energy_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/small_contact.h"

#include <catch2/catch.hpp>

#include <memory>

using namespace toile;
using test::tetrahedron;
using test::two_sheets;
using namespace toile::test;
using Eigen::VectorXd;

namespace {

Fabric woven() {
    Fabric f;
    f.name = "woven";
    f.density = 0.15;
    f.stretch_warp = 2000;
    f.stretch_weft = 900;
    f.poisson = 0.3;
    f.shear = 60;
    f.compression = 0.2;
    f.bend_warp = 2e-2;
    f.bend_weft = 1e-2;
    f.bend_twist = 4e-3;
    f.bend_poisson = 0.2;
    f.limit_warp = 0.05;
    f.limit_weft = 0.06;
    f.limit_shear = 0.15;
    return f;
}

const FlatMesh& mesh() {
    static const FlatMesh m = jittered_rectangle(0.3, 0.2, 0.05, 0.3, 5);
    return m;
}

Points shaken(Points x, double by, std::uint64_t seed) {
    Random random(seed);
    for (Vec3& p : x)
        p += random.vec3(by);
    return x;
}

// ---- the sheet itself

void add_sheet(std::vector<EnergyCase>& cases) {
    const Garment g = garment_of(mesh(), 0.3);
    const std::vector<Fabric> f{woven()};
    for (const TestedState& state : tested_states(mesh())) {
        cases.push_back({stretch_energy("stretch", make_stretch(g, f)), state});
        cases.push_back({stretch_energy("stretch with chords", make_stretch(g, f, {false})), state});
        cases.push_back({strain_limit_energy("strain limit", make_strain_limits(g, f)), state});
        cases.push_back({bend_energy("bend", make_bending(g, f)), state});
        TestedState angles = state; // at a triangle of 1e-7 m altitude, hinges turn within the step of the others
        if (state.name == "collapsed") angles.step = 5e-11;
        cases.push_back({model_energy("triangles", std::make_shared<TriangleCloth>(g, f)), angles});
        cases.push_back({model_energy("projective", std::make_shared<ProjectiveCloth>(g, f)), state});
        Garment folded = g;
        for (int e = 0; e < folded.edges.size(); e += 3) folded.rest.angles[e] = 1.5;
        const auto creases = make_creases(folded, f);
        REQUIRE(creases.size() > 5);
        cases.push_back({block_energy(
                             "creases", [=](const Points& at) { return value(creases, at); },
                             [=](const Points& at, VectorXd& g) { add_gradient(creases, at, g); },
                             [=](const Points& at, HessianKind kind, BlockMatrix& h) { add_hessian(creases, at, kind, h); }),
                         angles});
    }
}

// Bending that is curved at rest, at rest and elsewhere.
void add_curved(std::vector<EnergyCase>& cases) {
    const Cloth cloth = pressed(
        mesh(), [](const Vec2& p) -> Vec3 { return {p.x(), p.y(), 0.02 * std::sin(15 * p.x() + 5 * p.y())}; }, 0.3);
    const Bending bending = make_bending(cloth.garment, {woven()});
    const auto curved = make_rest_curvature(cloth.garment, {woven()});
    const TestedEnergy flat_part = bend_energy("", bending);
    const TestedEnergy energy{
        "curved bend", [=](const Points& x) { return flat_part.value(x) + value(curved, x); },
        [=](const Points& x, Points& g) {
            flat_part.gradient(x, g);
            VectorXd part = VectorXd::Zero(3 * x.size());
            add_gradient(curved, x, part);
            flat(g) += part;
        },
        [=](const Points& x, HessianKind kind) {
            Eigen::MatrixXd h = flat_part.hessian(x, kind);
            if (kind == HessianKind::projected) return h;
            return Eigen::MatrixXd(h + dense(int(h.rows()), [&](const VectorXd& v, VectorXd& y) {
                                       y.setZero(v.size());
                                       add_product(curved, x, v, y);
                                   }));
        }};
    for (TestedState state : tested_states(mesh())) {
        if (state.name == "collapsed") state.step = 5e-11; // its normal turns within the step of the others
        cases.push_back({energy, state});
    }
    cases.push_back({energy, {"near rest", shaken(cloth.x, 1e-3, 4)}});
}

// ---- contact

constexpr Barrier barrier{2e-3, 1e-4, 1e5};

enum class Pairs { node_triangle, edge_edge, any };

// `pairs`: what is to act at the state, and nothing else.
void add_contact(std::vector<EnergyCase>& cases, const std::string& name, const TriMesh& body,
                 const Points& x, Pairs pairs, double step = 1e-8) {
    INFO(name);
    const auto contact = std::make_shared<Contact>(two_sheets(), body, ContactOptions{barrier, barrier});
    const auto active = [contact](const Points& at) {
        contact->prepare(at, VectorXd::Zero(3 * at.size()));
        return contact->active(at);
    };
    REQUIRE(!active(x).empty());
    for (const ActivePair& a : active(x))
        if (pairs != Pairs::any) REQUIRE(contact->pair(a.pair).edge_edge == (pairs == Pairs::edge_edge));
    const TestedEnergy energy = block_energy(
        "contact", [=](const Points& at) { return contact->value(active(at)); },
        [=](const Points& at, VectorXd& g) { contact->add_gradient(active(at), g); },
        [=](const Points& at, HessianKind kind, BlockMatrix& h) {
            REQUIRE(contact->add_hessian(at, active(at), kind == HessianKind::exact, h));
        });
    cases.push_back({energy, {name, x, step}, body.points.empty()});
}

void add_contacts(std::vector<EnergyCase>& cases) {
    // The corner 3 of an upright triangle over a level one.
    const auto node_at = [](const Vec3& p) -> Points {
        return {{0, 0, 0},
                {0.02, 0.001, 0},
                {0.005, 0, 0.018},
                p,
                p + Vec3(0.004, 0.02, 0.001),
                p + Vec3(-0.003, 0.021, 0.002)};
    };
    add_contact(cases, "node over the inside", {}, shaken(node_at({0.008, 0.0012, 0.006}), 1e-4, 1),
                Pairs::node_triangle);
    add_contact(cases, "node over the inside, near the floor", {}, node_at({0.008, 0.00053, 0.006}),
                Pairs::node_triangle, 1e-9);
    add_contact(cases, "node beyond an edge", {}, shaken(node_at({0.01, 0.0009, -0.0008}), 1e-5, 2),
                Pairs::any);
    add_contact(cases, "node beyond a corner", {}, shaken(node_at({-0.0005, 0.0008, -0.0004}), 1e-5, 3),
                Pairs::any);

    // A roof's ridge 0-1 under the keel 3-4 of another, turned by an angle.
    const auto crossed = [](double angle, double gap) -> Points {
        const Vec3 half(0.01 * std::cos(angle), 0, 0.01 * std::sin(angle)), up(3e-4, gap, 1e-4);
        return {{-0.01, 0, 0.0004}, {0.0105, 0, 0},   {0, -0.02, 0.001},
                up - half,          up + 0.95 * half, {0.001, 0.022, 0}};
    };
    add_contact(cases, "edges crossed", {}, shaken(crossed(1.2, 1e-3), 1e-4, 4), Pairs::edge_edge);
    add_contact(cases, "edges crossed, near the floor", {}, crossed(0.9, 1.3e-4), Pairs::edge_edge, 1e-9);
    add_contact(cases, "edges all but parallel", {}, crossed(-0.017, 1e-3), Pairs::any, 1e-9);
    add_contact(cases, "edges a little less parallel", {}, crossed(0, 1.5e-3), Pairs::any, 1e-9);

    const Points over{{0.001, 0.0008, 0.002}, {0.021, 0.0011, 0.001},  {0.008, 0.0009, 0.019},
                      {0.004, 0.0016, 0.005}, {0.018, 0.0024, -0.004}, {0.002, 0.0019, 0.014}};
    add_contact(cases, "two sheets over each other", {}, over, Pairs::any);
    add_contact(cases, "two sheets over a body", tetrahedron(), over, Pairs::any);
    add_contact(
        cases, "two sheets over a body's corner", tetrahedron(),
        [&] {
            Points moved = over;
            for (Vec3& p : moved)
                p += Vec3(0.049, 0.0002, -0.042);
            return moved;
        }(),
        Pairs::any);
}

// ---- friction

void add_friction(std::vector<EnergyCase>& cases) {
    for (std::uint64_t seed : {1, 2}) {
        Random random(seed);
        Friction f;
        f.coefficient = 0.3;
        Points x;
        // At its place, near it, about to give way, just sliding, far gone; off the body by some.
        for (double slips : {0.0, 1e-10, 0.3, 0.999, 1.001, 1.5, 2.999, 3.001, 40.0, 0.5}) {
            const Vec3 n = random.vec3().normalized(), t = n.cross(random.vec3()).normalized();
            Tie& tie = f.ties.emplace_back(friction_at({random.vec3(0.1)}, 0).ties[0]);
            tie.point.fill(int(x.size()));
            tie.normal = n;
            tie.force = x.size() < 9 ? random.in(1e-4, 1e-2) : 0;
            tie.kept = seed == 1 ? 0.995 : 0.95;
            x.push_back(tie.place + slips * f.slip * t + random.in(-1e-3, 1e-3) * n);
        }
        const TestedEnergy energy = block_energy(
            "friction", [f](const Points& at) { return value(f, at); },
            [f](const Points& at, VectorXd& g) { add_gradient(f, at, g); },
            [f](const Points& at, HessianKind kind, BlockMatrix& h) {
                add_hessian(f, at, kind == HessianKind::exact, h);
            });
        cases.push_back({energy, {"sliding by more and more", x, 1e-10}, false});
    }
}

void add_cloth_friction(std::vector<EnergyCase>& cases) {
    Random random(3);
    const Points x = shaken(Points(6, Vec3(0.01, 0.02, 0.03)), 0.01, 9);
    Friction f;
    f.coefficient = 0.3;
    const std::array<std::array<double, 4>, 3> weights{{{1, -0.2, -0.5, -0.3}, {1, -0.6, 0, -0.4}, {0.7, 0.3, -0.1, -0.9}}};
    int turn = 0;
    for (double slips : {0.0, 0.3, 0.999, 1.5, 2.999, 40.0}) {
        const Vec3 n = random.vec3().normalized(), t = n.cross(random.vec3()).normalized();
        Tie& tie = f.ties.emplace_back();
        for (int k = 0; k < 4; ++k) tie.point[k] = (turn + k) % 6;
        tie.weight = weights[turn++ % 3];
        tie.normal = n;
        tie.force = random.in(1e-4, 1e-2);
        tie.place = held_vector(tie, x) - slips * f.slip * t + random.in(-1e-3, 1e-3) * n;
    }
    const TestedEnergy energy = block_energy(
        "friction of cloth", [f](const Points& at) { return value(f, at); },
        [f](const Points& at, VectorXd& g) { add_gradient(f, at, g); },
        [f](const Points& at, HessianKind kind, BlockMatrix& h) {
            CHECK(add_hessian(f, at, kind == HessianKind::exact, h));
        });
    cases.push_back({energy, {"sliding by more and more", x, 1e-10}, false});
}

// ---- springs

void add_springs(std::vector<EnergyCase>& cases) {
    const double k = 500, cap = 0.05; // a pull of 0.1 mm
    const std::vector<StitchSpring> stitches{
        {0, {1, 1}, 0, k, cap}, {1, {2, 3}, 0.3, k, cap}, {4, {0, 3}, 0.999, k, cap}, {5, {4, 4}, 0, k, cap}};
    const std::vector<HookSpring> hooks{{0, {0.1, 0.2, 0.3}, Vec3::UnitY(), k, cap},
                                        {1, {0, 0, 0}, Vec3::Ones(), k, cap},
                                        {2, {0.05, 0, 0}, Vec3(1, 0, 1), k, cap}};
    const TestedEnergy stitch = block_energy(
        "stitches", [=](const Points& x) { return value(stitches, x); },
        [=](const Points& x, VectorXd& g) { add_gradient(stitches, x, g); },
        [=](const Points& x, HessianKind, BlockMatrix& h) { add_hessian(stitches, x, h); });
    const TestedEnergy hook = block_energy(
        "hooks", [=](const Points& x) { return value(hooks, x); },
        [=](const Points& x, VectorXd& g) { add_gradient(hooks, x, g); },
        [=](const Points& x, HessianKind, BlockMatrix& h) { add_hessian(hooks, x, h); });
    const Points apart = shaken(Points(6, Vec3::Zero()), 0.05, 6);
    // Gaps below the cap, one of them almost closed and one just beyond the cap.
    Points near(6, Vec3(0.01, 0.02, 0.03));
    near = shaken(near, 2e-5, 7);
    near[4] = near[3] + Vec3(1e-9, 0, 0);
    near[5] = near[4] + Vec3(0, 1.001e-4, 0);
    Points at_hooks = near;
    at_hooks[0] = Vec3(0.7, 0.20003, 0.2);
    at_hooks[1] = Vec3(0, 0, 1e-9);
    at_hooks[2] = Vec3(0.05, 9, 1.001e-4);
    cases.push_back({stitch, {"far apart", apart}});
    cases.push_back({stitch, {"all but closed", near, 1e-9}});
    cases.push_back({hook, {"far apart", apart}, false});
    cases.push_back({hook, {"all but closed", at_hooks, 1e-9}, false});
}

// ---- elastic bands

void add_elastic(std::vector<EnergyCase>& cases) {
    // Along all sides of every third triangle, taut and slack in turn.
    std::vector<ElasticSegment> bands;
    for (std::size_t t = 0; t < mesh().triangles.size(); t += 3)
        for (int k = 0; k < 3; ++k) {
            const int a = mesh().triangles[t][k], b = mesh().triangles[t][(k + 1) % 3];
            const double ratio = t % 2 == 0 ? 0.2 : 1.5;
            bands.push_back({a, b, ratio * (mesh().points[a] - mesh().points[b]).norm(), 40});
        }
    const TestedEnergy energy = block_energy(
        "elastic", [=](const Points& x) { return value(bands, x); },
        [=](const Points& x, VectorXd& g) { add_gradient(bands, x, g); },
        [=](const Points& x, HessianKind, BlockMatrix& h) { add_hessian(bands, x, h); });
    for (const TestedState& state : tested_states(mesh()))
        cases.push_back({energy, state});
}

// ---- springs between all nodes

void add_models(std::vector<EnergyCase>& cases) {
    Fabric f = woven();
    const auto energy = [](const std::string& name, const std::vector<Spring>& springs) {
        const Springs all(springs);
        return block_energy(
            name, [=](const Points& x) { return all.value(x); },
            [=](const Points& x, VectorXd& g) { all.add_gradient(x, g); },
            [=](const Points& x, HessianKind kind, BlockMatrix& h) { all.add_hessian(x, kind, h); });
    };
    const Garment g = garment_of(mesh(), 0.3);
    for (const TestedState& state : tested_states(mesh())) {
        cases.push_back({energy("springs", mesh_springs(g, {f})), state});
        cases.push_back({energy("springs of two phases", mesh_springs(g, {f}, {0, 8})), state});
    }
    const SpringGrid grid{5, 4, 0.05};
    for (const Diagonals diagonals : {Diagonals::both, Diagonals::one})
        cases.push_back({energy("grid", grid_springs(grid, {900, 700, 80, 1e-2, 2e-2}, diagonals)),
                         {"shaken", shaken(grid_points(grid), 4e-3, 9)}});
}

// ---- all of them together, as the solver meets them

void add_problem(std::vector<EnergyCase>& cases) {
    const Garment garment = garment_of(mesh());
    const Barrier wide{5e-3, 5e-4, 1e5};
    const auto problem = std::make_shared<ClothProblem>(garment, PanelFabrics{woven()},
                                                        box(Vec3(0.05, -0.1, -0.05), Vec3(0.2, 0, 0.15)),
                                                        ContactOptions{wide, wide});
    problem->gravity = 9.81;
    problem->stitches = {{0, {7, 7}, 0, 500, 0.05}, {3, {9, 10}, 0.4, 500, 5}};
    problem->hooks = {{5, {0, 0.1, 0}, Vec3::UnitY(), 20, 0.1}};
    Points x;
    Random random(4);
    for (const Vec2& p : mesh().points)
        x.push_back(Vec3(p.x(), 0.003 + 0.002 * std::sin(40 * p.x()), p.y() - 0.05) + random.vec3(5e-4));
    problem->rest_here(shaken(x, 1e-4, 8), {0.4, 0.2});
    problem->arrive(x);
    const TestedEnergy energy{
        "cloth problem", [=](const Points& at) { return problem->value(at); },
        [=](const Points& at, Points& g) {
            VectorXd part;
            problem->touch(at);
            problem->gradient(at, part);
            flat(g) += part;
        },
        [=](const Points& at, HessianKind kind) {
            bool changed = false;
            problem->touch(at);
            const BlockMatrix& h = problem->hessian(at, kind == HessianKind::exact, changed);
            if (kind == HessianKind::projected) return dense(h);
            return dense(h.rows(), [&](const VectorXd& v, VectorXd& y) { problem->multiply(v, y); });
        }};
    cases.push_back({energy, {"on a body", x, 2e-8}, false});
}

void add_yarns(std::vector<EnergyCase>& cases) {
    const FlatMesh squares = halved_squares(6, 4, 0.05), irregular = mesh();
    for (const FlatMesh* m : {&squares, &irregular}) {
        const Garment g = garment_of(*m);
        const auto cloth = std::make_shared<YarnCloth>(g, std::vector<Fabric>{woven()}, yarn_edges(g));
        Random random(8);
        for (double& newtons : cloth->tension.newtons) newtons = random.in(-1, 3);
        for (double& stiffness : cloth->tension.stiffness) stiffness = random.in(0, 500);
        for (const TestedState& state : tested_states(*m)) cases.push_back({model_energy("yarns", cloth), state});
    }
}

std::vector<EnergyCase> every_energy() {
    std::vector<EnergyCase> cases;
    add_sheet(cases);
    add_curved(cases);
    add_contacts(cases);
    add_friction(cases);
    add_cloth_friction(cases);
    add_springs(cases);
    add_elastic(cases);
    add_models(cases);
    add_problem(cases);
    add_yarns(cases);
    return cases;
}

} // namespace

TEST_CASE("energies: gradient and Hessian by finite differences, rigid motions, convex model", "[energies]") {
    for (const EnergyCase& c : every_energy())
        check_energy(c);
}

TEST_CASE("energies: friction within the cloth takes energy and no momentum, and its matrix is its derivative", "[energies]") {
    const Garment garment = garment_of(mesh(), 0.3);
    const Springs springs(mesh_springs(garment, {woven()}, {1e-3, 1}));
    const TriangleCloth triangles(garment, {woven()}, 1e-3);
    const Points x = shaken(flat_points(mesh()), 3e-3, 2), v = shaken(Points(x.size(), Vec3::Zero()), 0.1, 4);
    const Points other = shaken(Points(x.size(), Vec3::Zero()), 0.1, 5);
    for (const Energy* energy : {static_cast<const Energy*>(&springs), static_cast<const Energy*>(&triangles)}) {
        INFO((energy == &springs ? "springs" : "triangles"));
        const auto force_at = [&](const VectorXd& velocity) {
            Points u(x.size());
            flat(u) = velocity;
            VectorXd force = VectorXd::Zero(velocity.size());
            energy->add_damping(x, u, force);
            return force;
        };
        BlockMatrix matrix = full_matrix(int(x.size()));
        energy->add_damping_matrix(x, 2.5, matrix);
        const Eigen::MatrixXd d = dense(matrix) / 2.5;
        const VectorXd force = force_at(flat(v));
        CHECK(force.norm() > 0);
        CHECK(force.dot(flat(v)) < 0);
        const VectorXd difference = (force_at(flat(v) + 0.01 * flat(other)) - force_at(flat(v) - 0.01 * flat(other))) / 0.02;
        CHECK((difference + d * flat(other)).norm() < 1e-10 * difference.norm());
        const VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(d).eigenvalues();
        CHECK(values[0] > -1e-10 * values[values.size() - 1]);
        Vec3 pull = Vec3::Zero(), spin = Vec3::Zero();
        Points rigid = v;
        for (std::size_t i = 0; i < x.size(); ++i) {
            pull += force.segment<3>(3 * i);
            spin += x[i].cross(force.segment<3>(3 * i));
            rigid[i] = Vec3(0.3, 0, 0.1) + Vec3(1, 2, 3).cross(x[i]);
        }
        CHECK(pull.norm() < 1e-11 * force.norm());
        CHECK(spin.norm() < 1e-11 * force.norm());
        CHECK(force_at(flat(rigid)).norm() < 1e-10 * force.norm());
    }
}
