// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/chart/scenes.h"

#include <cmath>
#include <numbers>

namespace toile {

namespace {

constexpr double side = 0.2;         // m
constexpr double stretch = 1000, shear = 40; // N/m
constexpr double bend = 2e-4;        // N m: so stiff that it does not wrinkle under this shear, and stays flat
constexpr double degree = std::numbers::pi / 180;
constexpr double answer = 0.5 * degree; // rad: laws in the angle and in its sine are 0.005 % apart here

} // namespace

// A frame of four hinged bars shears the cloth in it by an angle: yarns keep their lengths and turn towards each other. On its side whose normal
// is along the weft the frame pulls across the weft yarns, with shear * angle per length, and on the other sides likewise; that is all it does, so that
// these forces on the border stand for the bars. The lower side is held.
Scene picture_frame() {
    Scene s;
    s.name = "picture frame";
    s.quantity = "shear angle, rad";
    s.answer = s.scale = answer;
    s.edges = halved(side / 4, 4);
    s.make = [](double edge) {
        const SheetMesh mesh = sheet_mesh(MeshKind::alternating, side, side, edge);
        Fabric fabric = plain_cloth(stretch, bend);
        fabric.shear = shear;
        SceneCloth cloth = sheet(mesh, fabric);
        cloth.loads.gravity = 0;
        for (const Vec2& p : mesh.points) cloth.x.push_back({p.x(), p.y(), 0});
        const auto at = [](double c, double end) { return std::abs(c - end) < 1e-9; };
        const Vec3 up(0, 1, 0), along(std::cos(answer), -std::sin(answer), 0); // across the yarns as they will be
        for (std::size_t i = 0; i < mesh.points.size(); ++i) {
            const Vec2& p = mesh.points[i];
            if (at(p.y(), 0)) {
                cloth.held.push_back(int(i));
                continue;
            }
            // Squares have equal edges: half of a corner's two is on either side.
            const bool left = at(p.x(), 0), right = at(p.x(), side), top = at(p.y(), side);
            const double pull = shear * answer * side / std::round(side / edge);
            Vec3 force = Vec3::Zero();
            if (left || right) force += (right ? 1 : -1) * (top ? 0.5 : 1) * pull * up;
            if (top) force += (left || right ? 0.5 : 1) * pull * along;
            add_dead_load(cloth.loads, int(i), cloth.x[i], force);
        }
        return cloth;
    };
    s.measure = [](const SceneCloth& cloth, const Points& x) {
        double shift = 0;
        int nodes = 0;
        for (std::size_t i = 0; i < x.size(); ++i)
            if (cloth.x[i].y() > side - 1e-9) shift += x[i].x() - cloth.x[i].x(), ++nodes;
        return std::asin(shift / nodes / side);
    };
    return s;
}

} // namespace toile
