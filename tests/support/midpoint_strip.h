// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Strips of cloth on edge midpoints, on the meshes that a method has to bear.

#include "draping/nonconforming/cloth.h"
#include "tests/support/flat_mesh.h"
#include "tests/support/plates.h"

namespace toile::test {

/// Rectangles halved, or Delaunay triangles of jittered points.
inline FlatMesh strip_mesh(MeshKind kind, double length, double width, int along, std::uint64_t seed = 1) {
    if (kind == MeshKind::unstructured) return jittered_rectangle(length, width, length / along, 0.3, seed);
    return halved_rectangles(kind, length, width, along, std::max(1, int(std::lround(along * width / length))));
}

/// Isotropic, nu = 0.
inline Fabric sheet_fabric(double density, double bend) {
    Fabric f;
    f.name = "sheet";
    f.density = density;
    f.bend_warp = f.bend_weft = bend;
    f.bend_twist = bend / 2;
    return f;
}

/// Edges whose ends both lie on x = 0.
inline std::vector<int> edges_at_wall(const FlatMesh& mesh, const Garment& garment) {
    std::vector<int> edges;
    for (int e = 0; e < garment.edges.size(); ++e) {
        const auto& [a, b] = garment.edges.ends[e];
        if (mesh.points[a].x() < 1e-12 && mesh.points[b].x() < 1e-12) edges.push_back(e);
    }
    return edges;
}

/// A sheet in the plane z = 0 that leaves the wall at x = 0 level.
inline std::vector<Clamp> level_clamps(const std::vector<int>& edges) {
    std::vector<Clamp> clamps;
    for (int e : edges) {
        Clamp clamp;
        clamp.edge = e;
        clamp.slope << 1, 0, 0, 1, 0, 0;
        clamps.push_back(clamp);
    }
    return clamps;
}

struct Cantilever {
    IsometricResult result;
    double drop_over_reach = 0;
    double strain = 0; ///< largest of a triangle
    double bend = 0;   ///< J
    bool stable = false;
};

/// A strip of unit length, a quarter wide, with a bending of its own, from flat to rest.
inline Cantilever hang(const FlatMesh& mesh, double gamma, const NonconformingCloth& cloth) {
    const Garment garment = garment_of(mesh);
    const std::vector<int> wall = edges_at_wall(mesh, garment);
    IsometricProblem problem = problem_of(cloth, Vec3(0, 0, -gamma));
    Points x = midpoints_of(garment, flat_points(mesh));
    const double stiffness = cloth.bending.stiffness.diagonal().mean();
    for (int e : wall)
        add_spring(problem, {{e, 1.0}}, x[e], stiffness);
    Saddle saddle(problem.stiffness, problem.bars, problem.held);
    IsometricOptions options;
    options.tolerance = 1e-5 * gamma * 0.25 / garment.edges.size();
    Cantilever c;
    c.result = settle_isometric(saddle, problem, x, options);
    c.stable = is_stable(saddle, problem, x, c.result.tension);
    c.strain = largest_triangle_strain(garment, x);
    c.bend = bend_value(cloth.bending, x);
    const Points nodes = ghost_nodes(cloth.midpoints, x);
    double reach = 0, drop = 0;
    for (int i = 0; i < garment.node_count; ++i)
        if (mesh.points[i].x() > 1 - 1e-9) reach += nodes[i].x(), drop -= nodes[i].z();
    c.drop_over_reach = drop / reach;
    return c;
}

/// A strip of unit length, a quarter wide, D = 1, from flat to rest at gamma = weight per area times L^3 / D.
inline Cantilever hang(const FlatMesh& mesh, double gamma) {
    const Garment garment = garment_of(mesh);
    const std::vector<int> wall = edges_at_wall(mesh, garment);
    return hang(mesh, gamma, make_nonconforming_cloth(garment, {sheet_fabric(1, 1)}, level_clamps(wall)));
}

} // namespace toile::test
