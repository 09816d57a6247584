// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/chart/scenes.h"

#include "draping/chart/scene_rest.h"
#include "draping/cloth.h"
#include "draping/solve/settle.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace toile {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double radius = 0.05; // m
constexpr double roller_length = 0.04; // m
constexpr int facets = 120;
constexpr double width = 0.012, tail = 0.03; // m
constexpr double above = 0.45e-3;            // m, from the cylinder to the strip
constexpr double tension = 10;               // N/m, of the light end
constexpr double friction = 0.3;
// The strip is to slide a millimetre: less leaves ties of friction that have not given way, more is gone in steps that overshoot.
constexpr double drawn = 1.1; // of what slips, by which the spring pulls at first
constexpr double spring = 20; // N/m
constexpr double stretch = 2000, bend = 1e-5; // N/m, N m

TriMesh roller() {
    TriMesh mesh;
    const double step = 2 * pi / facets, wide = step * radius;
    const int rows = int(roller_length / wide);
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i < facets; ++i)
            mesh.points.push_back({radius * std::sin(i * step), radius * std::cos(i * step), (j - rows / 2.0) * wide});
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < facets; ++i) {
            const int a = j * facets + i, b = j * facets + (i + 1) % facets;
            mesh.triangles.push_back({a, b, b + facets});
            mesh.triangles.push_back({a, b + facets, a + facets});
        }
    return mesh;
}

/// Node by its share of an end of the strip.
using End = std::vector<std::pair<int, double>>;

End end_at(const SheetMesh& mesh, double x) {
    End end;
    for (std::size_t i = 0; i < mesh.points.size(); ++i)
        if (std::abs(mesh.points[i].x() - x) < 1e-9)
            end.emplace_back(int(i), mesh.points[i].y() < 1e-9 || mesh.points[i].y() > width - 1e-9 ? 0.5 : 1);
    for (auto& [node, share] : end) share /= double(end.size() - 1);
    return end;
}

void hang(SceneCloth& cloth, const End& end) {
    for (const auto& [node, share] : end) add_dead_load(cloth.loads, node, cloth.x[node], {0, -tension * width * share, 0});
}

/// Brings it to rest without friction and with one end held, as the default method does.
void lay(SceneCloth& cloth, const End& held) {
    ClothProblem problem(cloth.garment, cloth.fabrics, cloth.body, scene_contact(cloth));
    static_cast<Loads&>(problem) = cloth.loads;
    for (const auto& [node, share] : held) problem.pin(node);
    Cholesky factor;
    if (settle(problem, cloth.x, factor, {}).end != SettleEnd::settled) throw std::runtime_error("the strip of the capstan does not come to rest");
}

} // namespace

// A strip over a cylinder, half the way round, with a weight on one end. On the other a spring pulls by more than friction can bear, until as much of
// the strip has come over to it as leaves e^(friction * angle) of the weight.
Scene capstan() {
    Scene s;
    s.name = "capstan";
    s.quantity = "tension of the spring over that of the weight";
    s.answer = s.scale = std::exp(friction * pi);
    s.edges = halved(0.012, 4);
    s.make = [](double edge) {
        const double arc = pi * (radius + above), r = radius + above;
        const SheetMesh mesh = sheet_mesh(MeshKind::alternating, arc + 2 * tail, width, edge);
        SceneCloth cloth = sheet(mesh, plain_cloth(stretch, bend));
        cloth.loads.gravity = 0;
        cloth.body = roller();
        for (const Vec2& p : mesh.points) {
            const double along = p.x() - tail, z = p.y() - width / 2;
            if (along < 0)
                cloth.x.push_back({-r, along, z});
            else if (along > arc)
                cloth.x.push_back({r, arc - along, z});
            else
                cloth.x.push_back({-r * std::cos(along / r), r * std::sin(along / r), z});
        }
        const End weighted = end_at(mesh, 0), pulled = end_at(mesh, arc + 2 * tail);
        hang(cloth, weighted);
        lay(cloth, pulled);
        const double by = drawn * std::exp(friction * pi) * tension * width / spring;
        for (const auto& [node, share] : pulled)
            cloth.loads.hooks.push_back({node, cloth.x[node] - Vec3(0, by, 0), Vec3::UnitY(), spring * share, 1e3});
        cloth.friction = friction;
        return cloth;
    };
    s.measure = [](const SceneCloth& cloth, const Points& x) {
        double pull = 0;
        for (const HookSpring& h : cloth.loads.hooks)
            if (h.place.x() > 0) pull += h.stiffness * (x[h.node].y() - h.place.y());
        return pull / (tension * width);
    };
    return s;
}

} // namespace toile
