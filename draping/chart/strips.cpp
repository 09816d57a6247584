// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/chart/scenes.h"

#include "geometry/text.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace toile {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double cantilever_gamma = 10;
constexpr double arm = 0.1; // m

/// Drop over reach of the tip of a heavy elastica of unit length and stiffness, clamped level, of weight gamma and the given membrane stiffness:
/// with w = gamma (1 - s) below, e = w sin(phi) / membrane, phi'' = -(1 + e) w cos(phi), phi(0) = phi'(1) = 0, phi downward. Runge-Kutta
/// of fourth order from the tip, whose angle is found by bisection. 1.06680232 where nothing stretches.
double elastica_slope(double gamma, double membrane) {
    constexpr int steps = 2000;
    constexpr double h = 1.0 / steps;
    struct State {
        double phi, turn, reach, drop;
    };
    const auto rate = [&](double t, const State& a) { // t = 1 - s
        const double weight = gamma * t, stretched = 1 + weight * std::sin(a.phi) / membrane;
        return State{a.turn, -stretched * weight * std::cos(a.phi), stretched * std::cos(a.phi), stretched * std::sin(a.phi)};
    };
    const auto ahead = [](const State& a, double by, const State& r) {
        return State{a.phi + by * r.phi, a.turn + by * r.turn, a.reach + by * r.reach, a.drop + by * r.drop};
    };
    const auto at_root = [&](double tip) {
        State a{tip, 0, 0, 0};
        for (int i = 0; i < steps; ++i) {
            const double t = i * h;
            const State k1 = rate(t, a), k2 = rate(t + h / 2, ahead(a, h / 2, k1)), k3 = rate(t + h / 2, ahead(a, h / 2, k2)),
                        k4 = rate(t + h, ahead(a, h, k3));
            a = ahead(ahead(ahead(ahead(a, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
        }
        return a;
    };
    double low = 0, high = pi / 2; // the root's angle grows with the tip's
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (at_root(middle).phi < 0 ? low : high) = middle;
    }
    const State root = at_root(high);
    return root.drop / root.reach;
}

/// A strip along x, laid in space by `place` and held where x = 0.
SceneCloth clamped(const SheetMesh& mesh, const Fabric& fabric, const std::function<Vec3(const Vec2& flat)>& place) {
    SceneCloth cloth = sheet(mesh, fabric);
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        cloth.x.push_back(place(mesh.points[i]));
        if (std::abs(mesh.points[i].x()) < 1e-12) cloth.held.push_back(int(i));
    }
    return cloth;
}

/// Mean place of the end at the largest x of the start.
Vec3 tip(const SceneCloth& cloth, const Points& x) {
    double most = 0;
    for (const Vec3& p : cloth.x) most = std::max(most, p.x());
    Vec3 sum = Vec3::Zero();
    int nodes = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
        if (cloth.x[i].x() > most - 1e-9) sum += x[i], ++nodes;
    return sum / nodes;
}

// A strip clamped on edge leans over sideways once gamma passes 18.18 (narrow, without a Poisson effect); here it is half as much again.
constexpr double on_edge_gamma = 27;

} // namespace

Scene cantilever(MeshKind kind, const char* mesh_name, double membrane) {
    Scene s;
    s.name = text("cantilever, %s, %.0e", mesh_name, membrane);
    s.name.erase(std::remove(s.name.begin(), s.name.end(), '+'), s.name.end());
    s.quantity = "drop over reach of the tip";
    s.answer = s.scale = elastica_slope(cantilever_gamma, membrane);
    s.edges = halved(arm / 7, 4);
    s.make = [kind, membrane](double edge) {
        const double bend = scene_density * scene_gravity * arm * arm * arm / cantilever_gamma;
        const SheetMesh mesh = with_mirror_image(sheet_mesh(kind, arm, arm / 4, edge));
        return clamped(mesh, plain_cloth(membrane * bend / (arm * arm), bend), [](const Vec2& p) { return Vec3(p.x(), 0, -p.y()); });
    };
    s.measure = [](const SceneCloth& cloth, const Points& x) {
        const Vec3 end = tip(cloth, x);
        return -end.y() / end.x();
    };
    return s;
}

Scene strip_on_edge() {
    Scene s;
    s.name = "strip on edge";
    s.quantity = "lean of the tip over the length";
    s.edges = halved(arm / 7, 4);
    s.make = [](double edge) {
        const double bend = scene_density * scene_gravity * arm * arm * arm / on_edge_gamma;
        const SheetMesh mesh = with_mirror_image(sheet_mesh(MeshKind::unstructured, arm, arm / 5, edge));
        return clamped(mesh, plain_cloth(1e4 * bend / (arm * arm), bend), [](const Vec2& p) {
            const double along = p.x() / arm;
            return Vec3(p.x(), p.y(), 0.3 * arm * along * along); // to the side that it is to fall
        });
    };
    s.measure = [](const SceneCloth& cloth, const Points& x) { return tip(cloth, x).z() / arm; };
    return s;
}

} // namespace toile
