// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth without any forces of its own, under gravity: what a response does, and nothing else. The steps are explicit.

#include "draping/contact/response.h"
#include "tests/support/flat_mesh.h"

#include <limits>

namespace toile::test {

/// Any triangles as cloth, each node of mass `mass`.
struct Particles {
    ContactCloth cloth;
    Points x, v;
    std::vector<double> inverse_mass;
    double gravity = 9.81; ///< m/s2 along -y

    Particles(const Points& places, const std::vector<Triangle>& triangles, double mass)
        : x(places), v(places.size(), Vec3::Zero()), inverse_mass(places.size(), 1 / mass) {
        const EdgeTable edges = make_edges(triangles, int(places.size()));
        cloth.triangles = triangles;
        cloth.edges = edges.ends;
        cloth.node_area.assign(places.size(), 1e-4);
        cloth.node_reach.assign(places.size(), std::numeric_limits<double>::infinity());
        cloth.edge_area.assign(edges.size(), 1e-4);
        for (const auto& e : edges.ends) cloth.edge_length.push_back((x[e[1]] - x[e[0]]).norm());
        for (int i = 0; i < int(places.size()); ++i) cloth.group.push_back(i);
    }

    ResponseDone step(Response& response, double dt, const Points& body_end) {
        const Points start = v;
        for (std::size_t i = 0; i < v.size(); ++i)
            if (inverse_mass[i] > 0) v[i].y() -= gravity * dt;
        const ResponseDone done = response.respond({dt, x, start, inverse_mass, body_end}, v);
        for (std::size_t i = 0; i < v.size(); ++i) x[i] += dt * v[i];
        return done;
    }
    ResponseDone step(Response& response, double dt) { return step(response, dt, Points(response.body())); }
};

/// One horizontal face, facing up, at height y: 20 m wide.
inline TriMesh floor_face(double y = 0) { return {{{-10, y, -10}, {0, y, 10}, {10, y, -10}}, {{0, 1, 2}}}; }

/// A triangle of side 0.1 m at height y.
inline Points level_triangle(double y) { return {{0, y, 0}, {0.1, y, 0}, {0.05, y, 0.0866}}; }

/// `count` square sheets of `cells` x `cells` cells of `edge`, one above the other from `low` on, `gap` apart.
inline Particles stacked_sheets(int count, int cells, double edge, double low, double gap, double mass) {
    Points x;
    std::vector<Triangle> triangles;
    for (int s = 0; s < count; ++s) {
        const int first = int(x.size()), row = cells + 1;
        for (int j = 0; j <= cells; ++j)
            for (int i = 0; i <= cells; ++i) x.push_back({i * edge, low + s * gap, j * edge});
        for (int j = 0; j < cells; ++j)
            for (int i = 0; i < cells; ++i) {
                const int a = first + j * row + i;
                triangles.push_back({a, a + row, a + 1});
                triangles.push_back({a + 1, a + row, a + row + 1});
            }
    }
    return {x, triangles, mass};
}

} // namespace toile::test
