// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/chart/scene.h"

#include "geometry/text.h"
#include "sewing/mesh_grain.h"
#include "sewing/sheet_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace toile {

namespace {

constexpr double g = 9.81;       // m/s2
constexpr double density = 0.15; // kg/m2
constexpr double pi = std::numbers::pi;

std::vector<double> halved(double edge, int times) {
    std::vector<double> edges;
    for (int k = 0; k < times; ++k) edges.push_back(edge / (1 << k));
    return edges;
}

SceneCloth sheet(const SheetMesh& mesh, const Fabric& fabric) {
    SceneCloth cloth;
    cloth.garment = sheet_garment(mesh);
    cloth.fabrics = {fabric};
    cloth.gravity = g;
    return cloth;
}

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

Scene cantilever(MeshKind kind, const char* mesh_name, double membrane) {
    Scene s;
    s.name = text("cantilever, %s, %.0e", mesh_name, membrane);
    s.name.erase(std::remove(s.name.begin(), s.name.end(), '+'), s.name.end());
    s.quantity = "drop over reach of the tip";
    s.answer = s.scale = elastica_slope(cantilever_gamma, membrane);
    s.edges = halved(arm / 7, 4);
    s.make = [kind, membrane](double edge) {
        const double bend = density * g * arm * arm * arm / cantilever_gamma;
        const SheetMesh mesh = with_mirror_image(sheet_mesh(kind, arm, arm / 4, edge));
        SceneCloth cloth = sheet(mesh, plain_cloth(membrane * bend / (arm * arm), bend));
        for (std::size_t i = 0; i < mesh.points.size(); ++i) {
            const Vec2& p = mesh.points[i];
            cloth.x.push_back({p.x(), 0, -p.y()});
            if (std::abs(p.x()) < 1e-12) cloth.held.push_back(int(i));
        }
        return cloth;
    };
    s.measure = [](const SceneCloth& cloth, const Points& x) {
        double most = 0, reach = 0, drop = 0;
        for (const Vec3& p : cloth.x) most = std::max(most, p.x());
        for (std::size_t i = 0; i < x.size(); ++i)
            if (cloth.x[i].x() > most - 1e-9) reach += x[i].x(), drop -= x[i].y();
        return drop / reach;
    };
    return s;
}

// A strip clamped on edge leans over sideways once gamma passes 18.18 (narrow, without a Poisson effect); here it is half as much again.
constexpr double on_edge_gamma = 27;

Scene strip_on_edge() {
    Scene s;
    s.name = "strip on edge";
    s.quantity = "lean of the tip over the length";
    s.edges = halved(arm / 7, 4);
    s.make = [](double edge) {
        const double bend = density * g * arm * arm * arm / on_edge_gamma;
        const SheetMesh mesh = with_mirror_image(sheet_mesh(MeshKind::unstructured, arm, arm / 5, edge));
        SceneCloth cloth = sheet(mesh, plain_cloth(1e4 * bend / (arm * arm), bend));
        for (std::size_t i = 0; i < mesh.points.size(); ++i) {
            const Vec2& p = mesh.points[i];
            const double along = p.x() / arm;
            cloth.x.push_back({p.x(), p.y(), 0.3 * arm * along * along}); // to the side that it is to fall
            if (std::abs(p.x()) < 1e-12) cloth.held.push_back(int(i));
        }
        return cloth;
    };
    s.measure = [](const SceneCloth& cloth, const Points& x) {
        double most = 0, lean = 0;
        int tip = 0;
        for (const Vec3& p : cloth.x) most = std::max(most, p.x());
        for (std::size_t i = 0; i < x.size(); ++i)
            if (cloth.x[i].x() > most - 1e-9) lean += x[i].z(), ++tip;
        return lean / tip / arm;
    };
    return s;
}

// A chain of length L between supports d apart, L / d = 1.5: sinh(u) / u = L / d, sag = d (cosh(u) - 1) / 2 u.
constexpr double catenary_sag = 0.5026333, supports = 0.2; // of d; m
constexpr double arc_angle = 1.4957824; // rad, half of an arc as long for its chord: sin a = 2/3 a

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

// A disc without a sector of 90 degrees, its cut sewn up: a circle of radius r is 2 pi r sin(half angle) round the cone.
constexpr double cone_inner = 0.05, cone_outer = 0.2, cone_angle = 1.5 * pi; // m, m, rad
constexpr double cone_sine = 0.75;

Scene cone() {
    Scene s;
    s.name = "cone";
    s.quantity = "sine of the half angle";
    s.answer = s.scale = cone_sine;
    s.edges = halved(0.064, 4);
    s.make = [](double edge) {
        // (angle, log radius) to the plane keeps angles, so that triangles stay well shaped, of `edge` at the outer rim.
        const double height = std::log(cone_outer / cone_inner);
        const SheetMesh strip = sheet_mesh(MeshKind::unstructured, cone_angle, height, edge / cone_outer);
        std::vector<Vec2> flat;
        for (const Vec2& p : strip.points) flat.push_back(cone_inner * std::exp(p.y()) * Vec2(std::cos(p.x()), std::sin(p.x())));
        std::vector<int> node(flat.size(), -1); // of every point; the cut's two sides are one
        int nodes = 0;
        const double start = std::asin(cone_sine) + 4 * pi / 180; // of the wrong half angle, and with rings too long
        SceneCloth cloth;
        for (std::size_t i = 0; i < flat.size(); ++i) {
            if (strip.points[i].x() > cone_angle - 1e-9) continue;
            node[i] = nodes++;
            const double round = 2 * pi * strip.points[i].x() / cone_angle, slant = flat[i].norm();
            cloth.x.push_back(slant * Vec3(std::sin(start) * std::cos(round), -std::cos(start), std::sin(start) * std::sin(round)));
        }
        for (std::size_t i = 0; i < flat.size(); ++i)
            for (std::size_t j = 0; node[i] < 0 && j < flat.size(); ++j)
                if (strip.points[j].x() < 1e-9 && std::abs(strip.points[j].y() - strip.points[i].y()) < 1e-9) node[i] = node[j];
        std::vector<Triangle> triangles;
        std::vector<Mat2> edges;
        for (const Triangle& t : strip.triangles) {
            const Vec2 a = flat[t[1]] - flat[t[0]], b = flat[t[2]] - flat[t[0]];
            const bool turned = a.x() * b.y() < a.y() * b.x();
            const Triangle u = turned ? Triangle{t[0], t[2], t[1]} : t;
            Mat2 e;
            e << flat[u[1]] - flat[u[0]], flat[u[2]] - flat[u[0]];
            triangles.push_back({node[u[0]], node[u[1]], node[u[2]]});
            edges.push_back(e);
        }
        cloth.garment = mesh_garment(triangles, nodes, std::move(edges));
        cloth.fabrics = {plain_cloth(2000, 1e-5)};
        return cloth;
    };
    s.measure = [](const SceneCloth& cloth, const Points& x) {
        // Mean distances of both rims from the axis through their middles.
        std::vector<int> rim[2];
        Vec3 middle[2] = {Vec3::Zero(), Vec3::Zero()};
        double least = INFINITY, most = 0;
        for (const Vec3& p : cloth.x) least = std::min(least, p.norm()), most = std::max(most, p.norm());
        for (std::size_t i = 0; i < x.size(); ++i)
            for (int k = 0; k < 2; ++k)
                if (std::abs(cloth.x[i].norm() - (k == 0 ? least : most)) < 1e-9) rim[k].push_back(int(i)), middle[k] += x[i];
        for (int k = 0; k < 2; ++k) middle[k] /= double(rim[k].size());
        const Vec3 axis = (middle[1] - middle[0]).normalized();
        double radius[2] = {0, 0};
        for (int k = 0; k < 2; ++k)
            for (const int i : rim[k]) radius[k] += axis.cross(x[i] - middle[k]).norm() / double(rim[k].size());
        return (radius[1] - radius[0]) / (most - least);
    };
    return s;
}

constexpr double square_side = 0.3, square_apart = 0.9; // m; of the side, distance of the two corners

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

} // namespace

Fabric plain_cloth(double stretch, double bend) {
    Fabric f;
    f.name = "plain";
    f.density = density;
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
    scenes.push_back(cone());
    scenes.push_back(hung_square());
    return scenes;
}

} // namespace toile
