// SPDX-License-Identifier: GPL-3.0-or-later
// Sectors of discs whose two straight sides are one: cones, and the disc itself.

#include "draping/chart/scenes.h"
#include "sewing/mesh_grain.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace toile {

namespace {

constexpr double pi = std::numbers::pi;

/// A sector with a hole, cut along the x axis, whose cut is sewn up.
struct Sector {
    Garment garment;
    std::vector<Vec2> flat; ///< m, of every node, on the first side of the cut
};

/// Edges are of `edge` at the outer rim and shorter in proportion inward: (angle, log radius) to the plane keeps angles, so that triangles stay
/// well shaped.
Sector sewn_sector(double inner, double outer, double angle, double edge) {
    const SheetMesh strip = sheet_mesh(MeshKind::unstructured, angle, std::log(outer / inner), edge / outer);
    std::vector<Vec2> flat; // of every point
    for (const Vec2& p : strip.points) flat.push_back(inner * std::exp(p.y()) * Vec2(std::cos(p.x()), std::sin(p.x())));
    Sector sector;
    std::vector<int> node(flat.size(), -1); // of every point; the cut's two sides are one
    for (std::size_t i = 0; i < flat.size(); ++i) {
        if (strip.points[i].x() > angle - 1e-9) continue;
        node[i] = int(sector.flat.size());
        sector.flat.push_back(flat[i]);
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
    sector.garment = mesh_garment(triangles, int(sector.flat.size()), std::move(edges));
    return sector;
}

// A disc without a sector of 90 degrees, its cut sewn up: a circle of radius r is 2 pi r sin(half angle) round the cone.
constexpr double cone_inner = 0.05, cone_outer = 0.2, cone_angle = 1.5 * pi; // m, m, rad
constexpr double cone_sine = 0.75;

// Cusick's drape test: a disc of cloth lies between two smaller discs, and what is beyond them hangs down.
constexpr double plate = 0.09, disc = 0.15; // m
constexpr double disc_inner = 0.06;         // m, of the hole, where all is held
constexpr int shadow_rays = 720;

/// m2, of the shadow that light from above throws: as far out as any cloth is, in every direction from the axis.
double shadow(const Garment& garment, const Points& x) {
    std::vector<double> reach(shadow_rays, 0);
    constexpr double turn = 2 * pi / shadow_rays;
    for (const Triangle& t : node_triangles(garment))
        for (int k = 0; k < 3; ++k) {
            Vec2 a(x[t[k]].x(), x[t[k]].z()), b(x[t[(k + 1) % 3]].x(), x[t[(k + 1) % 3]].z());
            if (a.x() * b.y() < a.y() * b.x()) std::swap(a, b);
            const double cross = a.x() * b.y() - a.y() * b.x();
            if (cross == 0) continue; // seen from the axis it has no width
            const double from = std::atan2(a.y(), a.x()), to = from + std::atan2(cross, a.dot(b));
            for (int r = int(std::ceil(from / turn)); r * turn <= to; ++r) {
                const Vec2 ray(std::cos(r * turn), std::sin(r * turn));
                const Vec2 along = b - a;
                const double far = cross / (ray.x() * along.y() - ray.y() * along.x());
                double& most = reach[std::size_t((r + shadow_rays) % shadow_rays)];
                most = std::max(most, far);
            }
        }
    double area = 0;
    for (const double r : reach) area += 0.5 * turn * r * r;
    return area;
}

/// Cusick, The Dependence of Fabric Drape on Bending and Shear Stiffness, 1965, as it is quoted: percent, of a bending length in cm and the
/// angle of shear in degrees at which the cloth buckles.
double cusick_percent(double c, double angle) { return 35.6 * c - 3.61 * c * c - 2.59 * angle + 0.0461 * angle * angle + 17; }

constexpr double least_buckling = 10, most_buckling = 28; // degrees; the fit turns round beyond
constexpr double repeats = 5;                             // percent by which the same cloth comes out otherwise when it is laid anew

Band cusick_band(const Fabric& f) {
    const auto length = [&f](double bend) { return 100 * std::cbrt(bend / (f.density * scene_gravity)); };
    const double c = (length(f.bend_warp) + length(f.bend_weft)) / 2;
    return {(cusick_percent(c, most_buckling) - repeats) / 100, (cusick_percent(c, least_buckling) + repeats) / 100};
}

} // namespace

Scene cone() {
    Scene s;
    s.name = "cone";
    s.quantity = "sine of the half angle";
    s.answer = s.scale = cone_sine;
    s.edges = halved(0.064, 4);
    s.make = [](double edge) {
        Sector sector = sewn_sector(cone_inner, cone_outer, cone_angle, edge);
        const double start = std::asin(cone_sine) + 4 * pi / 180; // of the wrong half angle, and with rings too long
        SceneCloth cloth;
        for (const Vec2& p : sector.flat) {
            const double angle = std::atan2(p.y(), p.x()), round = 2 * pi * (angle < -1e-9 ? angle + 2 * pi : angle) / cone_angle;
            cloth.x.push_back(p.norm() * Vec3(std::sin(start) * std::cos(round), -std::cos(start), std::sin(start) * std::sin(round)));
        }
        cloth.garment = std::move(sector.garment);
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

Scene cusick_disc() {
    Scene s;
    s.name = "cusick disc";
    s.quantity = "drape coefficient";
    const Fabric& fabric = fabric_preset("poplin");
    s.band = cusick_band(fabric);
    s.answer_from = "Cusick's fit to measurements";
    s.edges = halved(0.024, 4);
    s.make = [fabric](double edge) {
        Sector whole = sewn_sector(disc_inner, disc, 2 * pi, edge);
        SceneCloth cloth;
        for (std::size_t i = 0; i < whole.flat.size(); ++i) {
            const Vec2& p = whole.flat[i];
            cloth.x.push_back({p.x(), 0, -p.y()});
            if (p.norm() < plate) cloth.held.push_back(int(i));
        }
        cloth.garment = std::move(whole.garment);
        cloth.fabrics = {fabric};
        cloth.loads.gravity = scene_gravity;
        return cloth;
    };
    s.measure = [](const SceneCloth& cloth, const Points& x) {
        const double under = pi * plate * plate;
        return (shadow(cloth.garment, x) - under) / (shadow(cloth.garment, cloth.x) - under);
    };
    return s;
}

} // namespace toile
