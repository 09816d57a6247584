// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Random scenes: several panels, of any shape, size and fabric, flung at a body that stands over a floor, and brought
// to rest there.

#include "draping/cloth.h"
#include "draping/inspect.h"
#include "draping/solve/settle.h"
#include "geometry/inside.h"
#include "sewing/arrange.h"
#include "tests/support/polygon.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace toile::test {

/// A sphere of `radius` that is drawn in to a third of it but for 18 points.
inline TriMesh spiky_star(double radius) {
    constexpr int spikes = 18; // of the octahedron, split once
    TriMesh star = sphere(radius, 2);
    for (std::size_t i = spikes; i < star.points.size(); ++i) star.points[i] /= 3;
    return star;
}

struct FlungScene {
    Garment garment;
    PanelFabrics fabrics; ///< by panel
    TriMesh body;         ///< with the floor
    Points x, velocity;   ///< m, m/s, by node
};

namespace flung {

inline Mat3 random_rotation(Random& random) {
    const Vec3 axis = random.vec3();
    return Eigen::AngleAxisd(random.in(0, 2 * std::numbers::pi), (axis + 1e-3 * Vec3::UnitX()).normalized())
        .toRotationMatrix();
}

/// A rectangle, a disc, a triangle or an L, 10 to 60 cm.
inline Loop random_outline(Random& random) {
    const double a = random.in(0.1, 0.6), b = random.in(0.1, 0.6);
    switch (random.below(4)) {
    case 0: return polygon({{0, 0}, {a, 0}, {a, b}, {0, b}});
    case 1: {
        const Arc half{a / 2, false, true};
        return {{{0, 0}, {a, 0}, half, {}}, {{a, 0}, {0, 0}, half, {}}};
    }
    case 2: return polygon({{0, 0}, {a, 0}, {random.in(0.1, 0.9) * a, b}});
    default: {
        const double s = random.in(0.3, 0.6), t = random.in(0.3, 0.6);
        return polygon({{0, 0}, {a, 0}, {a, t * b}, {s * a, t * b}, {s * a, b}, {0, b}});
    }
    }
}

inline double area_of(const Loop& outline) {
    double area = 0;
    for (const Edge& e : outline) {
        area += 0.5 * (e.start.x() * e.end.y() - e.end.x() * e.start.y());
        if (const Arc* arc = std::get_if<Arc>(&e.curve)) area += 0.5 * std::numbers::pi * arc->radius * arc->radius;
    }
    return area;
}

/// Two to four panels of some hundred nodes in all.
inline Pattern random_pattern(Random& random, double& edge_length) {
    Pattern pattern;
    double area = 0;
    for (int k = 2 + random.below(3); k > 0; --k) {
        Panel& panel = pattern.panels.emplace_back();
        panel.name = "panel " + std::to_string(pattern.panels.size());
        panel.outline = random_outline(random);
        panel.grain = random.in(0, std::numbers::pi);
        panel.fabric = fabric_presets()[random.below(int(fabric_presets().size()))].name;
        area += area_of(panel.outline);
    }
    edge_length = std::max(0.012, std::sqrt(area / (0.87 * random.in(200, 700))));
    return pattern;
}

/// The body turned at random, over a floor.
inline TriMesh stood(TriMesh body, Random& random) {
    const Mat3 turn = random_rotation(random);
    Eigen::AlignedBox3d bounds;
    for (Vec3& p : body.points) bounds.extend(p = turn * p);
    const double level = bounds.min().y() - random.in(0.02, 0.4);
    const TriMesh floor = box(Vec3(-5, level - 0.2, -5), Vec3(5, level, 5));
    const int first = int(body.points.size());
    body.points.insert(body.points.end(), floor.points.begin(), floor.points.end());
    for (const Triangle& t : floor.triangles)
        body.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    return body;
}

/// Puts a panel somewhere beside the body, with a velocity toward it.
inline void throw_panel(FlungScene& s, int panel, int corners_of_body, const Points& flat, Random& random) {
    const Vec3 target = s.body.points[random.below(corners_of_body)];
    const Vec3 away = random.vec3().normalized();
    const Vec3 place = target + random.in(0.1, 0.5) * away;
    const Mat3 turn = random_rotation(random);
    const Vec3 velocity = -random.in(1, 8) * away + random.vec3(), spin = random.vec3(8);
    Vec3 middle = Vec3::Zero();
    int count = 0;
    for (int i = 0; i < s.garment.node_count; ++i)
        if (s.garment.panel_of_vertex[i] == panel) {
            middle += flat[i];
            ++count;
        }
    middle /= count;
    for (int i = 0; i < s.garment.node_count; ++i) {
        if (s.garment.panel_of_vertex[i] != panel) continue;
        const Vec3 arm = turn * (flat[i] - middle);
        s.x[i] = place + arm;
        s.velocity[i] = velocity + spin.cross(arm);
    }
}

/// By code that the solver does not use.
inline bool is_clear(const FlungScene& s, const Points& x, const std::vector<Triangle>& cloth) {
    const IntersectionCount n = count_intersections(cloth, x, s.body);
    if (n.cloth_avatar + n.cloth_cloth > 0) return false;
    const std::vector<int> inside = winding_numbers(s.body, x);
    return std::all_of(inside.begin(), inside.end(), [](int w) { return w == 0; });
}

} // namespace flung

/// The scene of this number. Panels start where they touch nothing.
inline FlungScene flung_scene(const TriMesh& body, std::uint64_t number) {
    using namespace flung;
    Random random(number);
    FlungScene s;
    double edge_length;
    const Pattern pattern = random_pattern(random, edge_length);
    TriangulateOptions fine;
    fine.edge_length = edge_length;
    const FlatLevel level = triangulate(pattern, fine).levels[0];
    s.garment = sew(pattern, level);
    const Points flat = place(pattern, level);
    for (const Panel& p : pattern.panels) s.fabrics.push_back(fabric_preset(p.fabric));
    s.body = stood(body, random);
    s.x = flat;
    s.velocity.resize(flat.size());
    const std::vector<Triangle> all = node_triangles(s.garment);
    for (int panel = 0; panel < int(pattern.panels.size()); ++panel) {
        std::vector<Triangle> so_far;
        for (std::size_t t = 0; t < all.size(); ++t)
            if (s.garment.panel_of_triangle[t] <= panel) so_far.push_back(all[t]);
        // Nodes of later panels wait far off.
        do {
            for (std::size_t i = 0; i < flat.size(); ++i)
                if (s.garment.panel_of_vertex[i] > panel) s.x[i] = Vec3(0, 100, 0);
            throw_panel(s, panel, int(body.points.size()), flat, random);
        } while (!is_clear(s, s.x, so_far) || clearance_min(so_far, s.x, s.body) < 1e-3);
    }
    return s;
}

struct FlungEnd {
    bool at_rest = false;
    int iterations = 0;      ///< after the flight
    int crossing_flight = 0; ///< steps of the flight at whose end something crossed
    int crossings = 0;       ///< at the end: with the body, of the cloth with itself
    int nodes_inside = 0;    ///< of the body
    double clearance = 0;    ///< m, to the body
};

/// Lets the panels fly with momentum for an eighth of a second, every node as far as what it meets allows, and brings
/// them to rest under gravity, within so many iterations; without contact of cloth with cloth unless `self`.
inline FlungEnd fling(FlungScene& s, int most_iterations, bool self = true) {
    constexpr double dt = 5e-3, fastest = 10;
    constexpr double keep_off = 0.5; // of the way to what is in the way: step after step all of it ends on the barrier's floor
    constexpr int steps = 25;
    double density = 0;
    for (const Fabric& f : s.fabrics) density = std::max(density, f.density);
    ContactOptions contact = barriers_at(0.5e-3, density);
    contact.self = self;
    ClothProblem problem(s.garment, s.fabrics, s.body, contact);
    problem.gravity = 9.81;
    problem.rest_here(s.x, {0.3});
    Cholesky factor;
    SettleOptions settling;
    settling.tolerance = 1;
    settling.max_iterations = 3;
    settling.time_step = dt;
    settling.exact_below = 0;
    FlungEnd end;
    const std::vector<Triangle> cloth = node_triangles(s.garment);
    for (int k = 0; k < steps; ++k) {
        const Points before = s.x;
        for (Vec3& v : s.velocity) v.y() -= 9.81 * dt;
        Eigen::VectorXd dx = dt * flat(s.velocity);
        std::vector<double> shares;
        double t = problem.feasible_step(s.x, dx, &shares);
        if (t < 1) {
            for (std::size_t i = 0; i < shares.size(); ++i)
                if (shares[i] < 1) dx.segment<3>(3 * i) *= keep_off * shares[i];
            t = problem.feasible_step(s.x, dx);
        }
        flat(s.x) += (t < 1 ? keep_off * t : 1) * dx;
        settle(problem, s.x, factor, settling);
        for (std::size_t i = 0; i < s.x.size(); ++i) {
            s.velocity[i] = (s.x[i] - before[i]) / dt;
            s.velocity[i] *= std::min(1.0, fastest / std::max(fastest, s.velocity[i].norm()));
        }
        end.crossing_flight += !flung::is_clear(s, s.x, cloth);
    }
    SettleOptions resting;
    resting.time_step = dt;
    resting.max_iterations = most_iterations;
    const SettleResult r = settle(problem, s.x, factor, resting);
    const Inspection i = inspect(s.garment, s.x, s.body, s.fabrics);
    end.at_rest = r.end == SettleEnd::settled;
    end.iterations = r.iterations;
    end.crossings = i.intersections.cloth_avatar + i.intersections.cloth_cloth;
    end.nodes_inside = i.inside.nodes;
    end.clearance = i.clearance;
    return end;
}

} // namespace toile::test
