// SPDX-License-Identifier: GPL-3.0-or-later
// How far a strip hangs down by its weight, for every model of cloth, on meshes of three kinds: H/W at gamma 1, 10 and 100
// (the elastica of plates.h, integrated to 1e-8).

#include "draping/energy/projective.h"
#include "draping/energy/spring_mesh.h"
#include "draping/energy/triangles.h"
#include "draping/energy/yarns.h"

#include "tests/support/clamped_strip.h"
#include "tests/support/midpoint_strip.h"

#include <catch2/catch.hpp>

using namespace toile;
using namespace toile::test;

namespace {

constexpr std::array kinds{MeshKind::aligned, MeshKind::alternating, MeshKind::unstructured};
constexpr std::array<std::pair<double, double>, 3> slopes{{{1, 0.12456176644}, {10, 1.06680232}, {100, 5.8881046}}};

Fabric plate() {
    Fabric f;
    f.name = "plate";
    f.stretch_warp = f.stretch_weft = 1e5;
    f.shear = 5e4;
    f.compression = 1;
    f.bend_warp = f.bend_weft = 1;
    f.bend_twist = 0.5;
    return f;
}

double error_of(MeshKind kind, int along, double gamma, double slope,
                const std::function<std::vector<Term>(const Garment&)>& terms) {
    const Hung hung = hang(clamped_strip(strip_mesh(kind, 1, 0.25, along), terms), gamma);
    CHECK(hung.converged);
    CHECK(hung.stable);
    return hung.drop_over_reach / slope - 1;
}

std::vector<Term> equilibrium(const Garment& g) {
    return {stretch_term(make_stretch(g, {plate()}), g.node_count), bend_term(make_bending(g, {plate()}), g.node_count)};
}

template <class Model> std::vector<Term> model(const Garment& g) {
    return {model_term(std::make_shared<Model>(g, std::vector<Fabric>{plate()}), g.node_count)};
}

std::vector<Term> inextensible(const Garment& g) {
    auto cloth = std::make_shared<YarnCloth>(g, std::vector<Fabric>{plate()}, yarn_edges(g));
    cloth->tension.stiffness.assign(cloth->tension.lines().size(), 1e5);
    return {model_term(cloth, g.node_count)};
}

std::vector<Term> springs(const Garment& g) {
    return {model_term(std::make_shared<Springs>(mesh_springs(g, {plate()}, {})), g.node_count)};
}

} // namespace

TEST_CASE("cantilever: bending by shared slopes is within 2 % on any mesh and under any weight", "[validation]") {
    for (const auto& [gamma, slope] : slopes)
        for (const MeshKind kind : kinds) {
            INFO("gamma " << gamma << ", mesh " << int(kind));
            CHECK(std::abs(error_of(kind, 40, gamma, slope, equilibrium)) < 0.02);
            CHECK(std::abs(error_of(kind, 40, gamma, slope, model<ProjectiveCloth>)) < 0.02);
            // Its yarns are edges, which an unstructured mesh does not lay along the grain.
            if (kind != MeshKind::unstructured) CHECK(std::abs(error_of(kind, 40, gamma, slope, inextensible)) < 0.02);
        }
}

// A cylinder costs a grid of hinges what it should; but their diagonals couple its curvature to one across, which is free,
// and with that the strip is softer. Hinges of all directions average out.
TEST_CASE("cantilever: hinges, and springs that stand for them, are off by what the mesh makes of them", "[validation]") {
    for (const auto& [gamma, slope] : slopes)
        for (const MeshKind kind : kinds) {
            INFO("gamma " << gamma << ", mesh " << int(kind));
            const double off = error_of(kind, 28, gamma, slope, model<TriangleCloth>);
            CHECK(off < (kind == MeshKind::unstructured ? 0.03 : 0.23));
            CHECK(off > (kind == MeshKind::unstructured ? -0.03 : 0.02));
            CHECK(error_of(kind, 28, gamma, slope, springs) == Approx(off).margin(0.01));
        }
}
