// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/chart/scenes.h"

namespace toile {

namespace {

constexpr double dead_load_reach = 0.1; // m

} // namespace

std::vector<double> halved(double edge, int times) {
    std::vector<double> edges;
    for (int k = 0; k < times; ++k) edges.push_back(edge / (1 << k));
    return edges;
}

SceneCloth sheet(const SheetMesh& mesh, const Fabric& fabric) {
    SceneCloth cloth;
    cloth.garment = sheet_garment(mesh);
    cloth.fabrics = {fabric};
    cloth.loads.gravity = scene_gravity;
    return cloth;
}

void add_dead_load(Loads& loads, int node, const Vec3& x, const Vec3& force) {
    for (int k = 0; k < 3; ++k) {
        if (force[k] == 0) continue;
        const Vec3 axis = Vec3::Unit(k);
        const double size = std::abs(force[k]);
        loads.hooks.push_back({node, x + std::copysign(2 * dead_load_reach, force[k]) * axis, axis, size / dead_load_reach, size});
    }
}

Fabric plain_cloth(double stretch, double bend) {
    Fabric f;
    f.name = "plain";
    f.density = scene_density;
    f.stretch_warp = f.stretch_weft = stretch;
    f.shear = stretch / 2;
    f.bend_warp = f.bend_weft = bend;
    f.bend_twist = bend / 2;
    f.compression = 1;
    f.limit_warp = f.limit_weft = f.limit_shear = 1; // none that anything here comes near
    return f;
}

std::vector<Scene> chart_scenes() {
    std::vector<Scene> scenes;
    for (const double membrane : {1e4, 1e6})
        for (const auto& [kind, name] : {std::pair{MeshKind::aligned, "aligned"}, {MeshKind::alternating, "alternating"},
                                         {MeshKind::unstructured, "unstructured"}})
            scenes.push_back(cantilever(kind, name, membrane));
    scenes.push_back(strip_on_edge());
    scenes.push_back(catenary());
    scenes.push_back(picture_frame());
    scenes.push_back(cone());
    scenes.push_back(hung_square());
    scenes.push_back(capstan());
    scenes.push_back(cusick_disc());
    return scenes;
}

} // namespace toile
