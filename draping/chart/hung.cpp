// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/chart/scenes.h"

#include <algorithm>
#include <cmath>

namespace toile {

namespace {

// A chain of length L between supports d apart, L / d = 1.5: sinh(u) / u = L / d, sag = d (cosh(u) - 1) / 2 u.
constexpr double catenary_sag = 0.5026333, supports = 0.2; // of d; m
constexpr double arc_angle = 1.4957824; // rad, half of an arc as long for its chord: sin a = 2/3 a
constexpr double square_side = 0.3, square_apart = 0.9; // m; of the side, distance of the two corners

} // namespace

Scene catenary() {
    Scene s;
    s.name = "catenary";
    s.quantity = "sag over the distance of the supports";
    s.answer = s.scale = catenary_sag;
    s.edges = halved(0.03, 4);
    s.make = [](double edge) {
        const double length = 1.5 * supports;
        const SheetMesh mesh = sheet_mesh(MeshKind::alternating, length, 0.06, edge);
        SceneCloth cloth = sheet(mesh, plain_cloth(1e4, 1e-7)); // stretched by 5e-5, and too limp to tell from a chain
        for (std::size_t i = 0; i < mesh.points.size(); ++i) { // an arc of a circle: from a taut V some meshes keep its fold as a dimple
            const double along = mesh.points[i].x() / length, angle = arc_angle * (2 * along - 1), radius = length / (2 * arc_angle);
            cloth.x.push_back({radius * std::sin(angle), radius * (std::cos(arc_angle) - std::cos(angle)), -mesh.points[i].y()});
            if (along < 1e-9 || along > 1 - 1e-9) cloth.held.push_back(int(i));
        }
        return cloth;
    };
    s.measure = [](const SceneCloth&, const Points& x) {
        double lowest = 0;
        for (const Vec3& p : x) lowest = std::min(lowest, p.y());
        return -lowest / supports;
    };
    return s;
}

Scene hung_square() {
    Scene s;
    s.name = "hung square";
    s.quantity = "sag of the upper border over the side";
    s.edges = halved(0.03, 4);
    s.make = [](double edge) {
        const SheetMesh mesh = sheet_mesh(MeshKind::unstructured, square_side, square_side, edge);
        SceneCloth cloth = sheet(mesh, plain_cloth(1e3, 1e-3));
        for (std::size_t i = 0; i < mesh.points.size(); ++i) { // folded down its middle
            const double across = mesh.points[i].x() - square_side / 2, down = mesh.points[i].y() - square_side;
            const double out = std::sqrt(1 - square_apart * square_apart) * (square_side / 2 - std::abs(across));
            cloth.x.push_back({square_apart * across, down, out});
            if (down > -1e-9 && std::abs(across) > square_side / 2 - 1e-9) cloth.held.push_back(int(i));
        }
        return cloth;
    };
    s.measure = [](const SceneCloth& cloth, const Points& x) {
        double lowest = 0;
        for (std::size_t i = 0; i < x.size(); ++i)
            if (cloth.x[i].y() > -1e-9) lowest = std::min(lowest, x[i].y());
        return -lowest / square_side;
    };
    return s;
}

} // namespace toile
