// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth whose yarns keep their lengths, against what chains of rigid links do.

#include "draping/cloth.h"
#include "draping/energy/yarns.h"
#include "draping/solve/inextensible.h"

#include "tests/support/flat_mesh.h"
#include "tests/support/free_springs.h"
#include "tests/support/plain_fabric.h"

#include <catch2/catch.hpp>


using namespace toile;
using namespace toile::test;

namespace {

/// Cloth of yarns that meets nothing.
struct FreeYarns {
    Garment garment;
    std::unique_ptr<FreeCloth> owned;
    FreeCloth& problem;
    Tension& tension;
    NoContact response;
    std::unique_ptr<InextensibleStepper> stepper;
    Moving cloth;

    static std::unique_ptr<FreeCloth> make(const Garment& g, const Fabric& f, std::vector<LengthConstraint> yarns, Tension*& t) {
        auto energy = std::make_unique<YarnCloth>(g, std::vector<Fabric>{f}, std::move(yarns));
        t = &energy->tension;
        return std::make_unique<FreeCloth>(std::move(energy), node_masses(g, {f}));
    }
    FreeYarns(Garment g, const Fabric& f, const Points& x, const StepOptions& step) : FreeYarns(g, f, yarn_edges(g), x, step) {}
    FreeYarns(Garment g, const Fabric& f, std::vector<LengthConstraint> yarns, const Points& x, const StepOptions& step,
              Tension* t = nullptr)
        : garment(std::move(g)), owned(make(garment, f, std::move(yarns), t)), problem(*owned), tension(*t) {
        stepper = std::make_unique<InextensibleStepper>(std::move(owned), tension, response, step);
        cloth.x = x;
        cloth.velocity.assign(x.size(), Vec3::Zero());
    }
    FreeYarns(const FreeYarns&) = delete;

    void pin(int i) { problem.pin(i); }
};

/// Half a chain of `links` links of length l that hangs between two points d apart: its nodes from one end on. Each weighs
/// the same, and n / 2 - k of them pull at link k, whose direction is (H, that weight); H makes it reach half way.
struct Chain {
    std::vector<Vec2> at{{0, 0}};
    double pull = 0; ///< H over the weight of a node

    Chain(int links, double l, double d) {
        const auto weight = [&](int k) { return 0.5 * (links - 1) - k; };
        const auto reach = [&](double h) {
            double sum = 0;
            for (int k = 0; k < links / 2; ++k) sum += l * h / std::hypot(h, weight(k));
            return sum - d / 2;
        };
        double h = 0.2 * links;
        for (int round = 0; round < 100; ++round) {
            double slope = 0;
            for (int k = 0; k < links / 2; ++k) slope += l * weight(k) * weight(k) / std::pow(std::hypot(h, weight(k)), 3);
            h = std::max(0.5 * h, h - reach(h) / slope);
        }
        pull = h;
        for (int k = 0; k < links / 2; ++k)
            at.push_back(at.back() + l / std::hypot(h, weight(k)) * Vec2(h, -weight(k)));
    }
};

} // namespace

TEST_CASE("inextensible: a strip between two points hangs as the chain of its links", "[inextensible]") {
    const double dt = GENERATE(2e-3, 1e-2); // the longer one is beyond sqrt(m l / T), 8 ms at the ends
    const int links = 64;
    const double edge = 0.02, length = links * edge, apart = length / 1.5;
    const Chain chain(links, edge, apart);
    // The chain itself against the continuous one.
    CHECK(-chain.at.back().y() / apart == Approx(0.5026333).epsilon(1e-3));
    CHECK(chain.pull / links == Approx(0.2054910).epsilon(1e-3));

    // One column of squares, its two rails side by side along z. Laid out as a V.
    const FlatMesh mesh = halved_squares(1, links, edge, false); // whose nodes weigh the same
    Points x;
    const double drop = std::sqrt(length * length - apart * apart) / length;
    for (const Vec2& p : mesh.points)
        x.push_back({apart * p.y() / length, -drop * std::min(p.y(), length - p.y()), p.x()});
    FreeYarns strip(garment_of(mesh), plain_fabric(1000, 1e-14), x, {dt, 8, 0.02});
    for (const int i : {0, 1, 2 * links, 2 * links + 1}) strip.pin(i);
    strip.stepper->loads().gravity = 9.81;
    RestOptions rest;
    rest.tolerance = 1e-6;
    rest.speed = 1e-7;
    rest.max_steps = 4000;
    const RestResult r = come_to_rest(*strip.stepper, strip.cloth, {}, rest);
    INFO("steps of " << dt << " s: after " << r.steps << " residual " << r.residual << " speed " << r.speed << " strain "
                  << strip.stepper->largest_strain());
    CHECK(r.rested);
    double most = 0;
    for (int k = 0; k <= links / 2; ++k)
        for (int rail = 0; rail < 2; ++rail) {
            const Vec3 &left = strip.cloth.x[2 * k + rail], &right = strip.cloth.x[2 * (links - k) + rail];
            most = std::max(most, (left - Vec3(chain.at[k].x(), chain.at[k].y(), rail * edge)).norm());
            most = std::max(most, (right - Vec3(apart - chain.at[k].x(), chain.at[k].y(), rail * edge)).norm());
        }
    CHECK(most / apart < 1e-6);
    CHECK(strip.stepper->largest_strain() <= 1e-8);
    // What the yarns pull with is the chain's.
    const double weight = 9.81 * strip.problem.node_mass()[links];
    for (std::size_t k = 0; k < strip.tension.lines().size(); ++k) {
        const LengthConstraint& c = strip.tension.lines()[k];
        if (c.a == links && c.b == links + 2)
            CHECK(strip.tension.newtons[k] / weight == Approx(std::hypot(chain.pull, 0.5)).epsilon(1e-4));
    }
}

TEST_CASE("inextensible: in free flight cloth keeps its momentum and lengths and gains no energy", "[inextensible]") {
    const FlatMesh mesh = halved_squares(12, 10, 0.02);
    Points x;
    for (const Vec2& p : mesh.points) x.push_back({p.x(), p.y(), 0});
    FreeYarns sheet(garment_of(mesh), plain_fabric(1000, 1e-5), x, {2e-3, 0, 1e9});
    // A turn, a flight and folds: of the roughest that come, what the yarns allow.
    Random random(3);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Vec2 p = mesh.points[i];
        sheet.cloth.velocity[i] = Vec3(0.3, -0.1, 0.2) + Vec3(0, 0, 4).cross(x[i]) + Vec3(0, 0, std::sin(40 * p.x()) + p.y() * 8);
        sheet.cloth.velocity[i] += random.vec3(0.2);
    }
    const std::vector<double>& mass = sheet.problem.node_mass();
    const auto momentum = [&] {
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = 0; i < mass.size(); ++i) sum += mass[i] * sheet.cloth.velocity[i];
        return sum;
    };
    const auto energy = [&] { return sheet.problem.value(sheet.cloth.x) + kinetic_energy(mass, sheet.cloth); };
    const Vec3 first = momentum();
    double before = 0, most = 0, strain = 0, worst_step = -1e300;
    for (int step = 0; step < 400; ++step) {
        sheet.stepper->step(sheet.cloth, {});
        const double now = energy();
        // The first step takes away what the yarns do not allow of the velocities that it begins with.
        if (step > 0) worst_step = std::max(worst_step, now / before - 1);
        before = now;
        most = std::max(most, (momentum() - first).norm() / first.norm());
        strain = std::max(strain, sheet.stepper->largest_strain());
        CHECK(sheet.stepper->projected().iterations <= 6);
    }
    CHECK(most < 1e-11);
    CHECK(strain <= 1e-8);
    CHECK(worst_step < 0);
}

TEST_CASE("inextensible: a swinging strip loses energy alone", "[inextensible]") {
    const int links = 20;
    const FlatMesh mesh = halved_squares(1, links, 0.02);
    Points x;
    for (const Vec2& p : mesh.points) x.push_back({0.8 * p.y(), -0.6 * p.y(), p.x()});
    FreeYarns strip(garment_of(mesh), plain_fabric(1000, 1e-7), x, {2e-3, 0, 1e9});
    for (const int i : {0, 1}) strip.pin(i);
    strip.stepper->loads().gravity = 9.81;
    const auto energy = [&] { return strip.problem.value(strip.cloth.x) + kinetic_energy(strip.problem.node_mass(), strip.cloth); };
    double low = energy(), rise = 0;
    const double first = low;
    for (int step = 0; step < 500; ++step) {
        strip.stepper->step(strip.cloth, {});
        rise = std::max(rise, energy() - low);
        low = std::min(low, energy());
        CHECK(strip.stepper->projected().converged);
    }
    CHECK(rise < 1e-6 * (first - low));
    CHECK(low < first);
}

TEST_CASE("inextensible: a mesh all of whose edges keep their lengths locks", "[inextensible]") {
    // A sheet that sticks out by 16 cm from where two columns of its nodes are held, and would hang nearly plumb.
    const double edge = 0.02, length = 0.18, width = 0.12;
    const auto droop = [&](const FlatMesh& mesh, bool every_edge, double& freedom) {
        const Garment g = garment_of(mesh);
        std::vector<LengthConstraint> lines = yarn_edges(g);
        if (every_edge) lines.clear();
        for (int e = 0; every_edge && e < g.edges.size(); ++e) {
            const auto [a, b] = g.edges.ends[e];
            lines.push_back({a, b, (mesh.points[a] - mesh.points[b]).norm()});
        }
        Points x;
        for (const Vec2& p : mesh.points) x.push_back({p.x(), 0, p.y()});
        FreeYarns sheet(g, plain_fabric(1000, 1e-5), lines, x, {2e-3, 8, 0.02});
        int free_nodes = 0, free_lines = 0;
        for (int i = 0; i < g.node_count; ++i)
            if (mesh.points[i].x() < 1.2 * edge)
                sheet.pin(i);
            else
                ++free_nodes;
        for (const LengthConstraint& c : lines) free_lines += std::max(mesh.points[c.a].x(), mesh.points[c.b].x()) > 1.2 * edge;
        freedom = double(free_lines) / (3 * free_nodes);
        sheet.stepper->loads().gravity = 9.81;
        for (int step = 0; step < 500; ++step) sheet.stepper->step(sheet.cloth, {});
        double drop = 0;
        for (const Vec3& p : sheet.cloth.x) drop = std::max(drop, -p.y());
        return drop;
    };
    double of_squares = 0, of_triangles = 0;
    const double hangs = droop(halved_squares(9, 6, edge), false, of_squares);
    const double locked = droop(jittered_rectangle(length, width, edge, 0.25, 3), true, of_triangles);
    INFO("squares: " << of_squares << " lines per unknown, hangs by " << hangs << " m; triangles: " << of_triangles << ", "
                     << locked << " m");
    CHECK(of_squares < 0.68);
    CHECK(of_triangles > 0.85);
    CHECK(hangs > 0.12);
    CHECK(locked < 0.5 * hangs);
}
