// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Small unstructured meshes for tests that must not wait for the pattern pipeline.

#include "geometry/tri_mesh.h"
#include "sewing/garment.h"
#include "sewing/sheet_mesh.h"
#include "tests/support/random.h"

#include <algorithm>
#include <map>

namespace toile::test {

using FlatMesh = SheetMesh;

inline double cross(const Vec2& a, const Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}

/// Delaunay triangulation of points in a convex outline by Bowyer and Watson, with every circumcircle asked:
/// for some thousand points.
inline std::vector<Triangle> delaunay(std::vector<Vec2> points) {
    const std::vector<Vec2> given = points;
    const int n = int(points.size());
    Vec2 low = points[0], high = points[0];
    for (const Vec2& p : points)
        low = low.cwiseMin(p), high = high.cwiseMax(p);
    const Vec2 centre = (low + high) / 2;
    // Bulged and shaken a little, so that no three points of a straight border lie on a line and no four on a
    // circle.
    Random random(1);
    const double size = (high - low).norm();
    for (Vec2& p : points) {
        p -= 1e-3 * (p - centre).squaredNorm() / (size * size) * (p - centre);
        p += 1e-7 * size * random.vec3().head<2>();
    }
    const double far = 20 * size;
    for (const Vec2& d : {Vec2(-1, -0.9), Vec2(1, -1.1), Vec2(0.01, 1)})
        points.push_back(centre + far * d);

    const auto in_circle = [&](const Triangle& t, const Vec2& p) {
        const Vec2 a = points[t[0]] - p, b = points[t[1]] - p, c = points[t[2]] - p;
        return a.squaredNorm() * cross(b, c) + b.squaredNorm() * cross(c, a) + c.squaredNorm() * cross(a, b) >
               0;
    };
    std::vector<Triangle> triangles{{n, n + 1, n + 2}}, kept;
    for (int i = 0; i < n; ++i) {
        std::map<std::array<int, 2>, bool> hole;
        kept.clear();
        for (const Triangle& t : triangles) {
            if (!in_circle(t, points[i])) {
                kept.push_back(t);
                continue;
            }
            for (int k = 0; k < 3; ++k)
                hole[{t[k], t[(k + 1) % 3]}] = true;
        }
        for (const auto& [edge, inside] : hole)
            if (!hole.count({edge[1], edge[0]})) kept.push_back({edge[0], edge[1], i});
        triangles.swap(kept);
    }
    std::vector<Triangle> result;
    for (const Triangle& t : triangles) {
        if (*std::max_element(t.begin(), t.end()) >= n) continue;
        const Vec2 a = given[t[1]] - given[t[0]], b = given[t[2]] - given[t[0]];
        if (cross(a, b) > 1e-6 * std::max(a.squaredNorm(), b.squaredNorm())) result.push_back(t);
    }
    return result;
}

/// Rectangle [0, length] x [0, width]: border samples about `edge` apart, inside a hexagonal lattice moved by
/// up to `jitter` edges in each coordinate (but not closer than 0.45 edges to the border).
inline FlatMesh jittered_rectangle(double length, double width, double edge, double jitter,
                                   std::uint64_t seed) {
    Random random(seed);
    FlatMesh mesh;
    const int along = std::max(1, int(std::lround(length / edge))),
              up = std::max(1, int(std::lround(width / edge)));
    for (int i = 0; i < along; ++i)
        mesh.points.push_back({length * i / along, 0});
    for (int j = 0; j < up; ++j)
        mesh.points.push_back({length, width * j / up});
    for (int i = along; i > 0; --i)
        mesh.points.push_back({length * i / along, width});
    for (int j = up; j > 0; --j)
        mesh.points.push_back({0, width * j / up});
    const int rows = std::max(1, int(std::lround(width / (0.8660254 * edge))));
    const double margin = 0.45 * edge;
    for (int j = 1; j < rows; ++j)
        for (int i = 0; i < along; ++i) {
            if (i == 0 && j % 2 == 0) continue;
            const double dx = edge * random.in(-jitter, jitter), dy = edge * random.in(-jitter, jitter);
            const double x = length * (i + 0.5 * (j % 2)) / along + dx, y = width * j / rows + dy;
            mesh.points.push_back(
                {std::clamp(x, margin, length - margin), std::clamp(y, margin, width - margin)});
        }
    mesh.triangles = delaunay(mesh.points);
    return mesh;
}

/// Squares along the axes, each halved by a diagonal, all the same way or every second one the other way: node i + (columns + 1) j at (i, j) times the edge.
inline FlatMesh halved_squares(int columns, int rows, double edge, bool alternating = true) {
    FlatMesh mesh;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) mesh.points.push_back({i * edge, j * edge});
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const int a = i + (columns + 1) * j, b = a + 1, c = a + columns + 1, d = c + 1;
            if (!alternating || (i + j) % 2 == 0)
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}});
            else
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {b, d, c}});
        }
    return mesh;
}

/// One panel, one node per vertex, grain along the axes turned by `grain` radians (0: warp along y).
inline Garment garment_of(const FlatMesh& mesh, double grain = 0) {
    Garment garment;
    Mat2 turn;
    turn << std::cos(grain), -std::sin(grain), std::sin(grain), std::cos(grain);
    for (const Vec2& p : mesh.points)
        garment.uv.push_back(turn * p);
    garment.triangles = mesh.triangles;
    garment.panel_of_vertex.assign(mesh.points.size(), 0);
    garment.panel_of_triangle.assign(mesh.triangles.size(), 0);
    garment.panel_names = {"panel"};
    garment.panel_fabrics = {""};
    garment.panel_layers = {0};
    garment.node_count = int(mesh.points.size());
    for (int i = 0; i < garment.node_count; ++i)
        garment.node_of_vertex.push_back(i);
    garment.edges = make_edges(mesh.triangles, garment.node_count);
    garment.rest.angles.assign(garment.edges.size(), 0);
    garment.seam_edge.assign(garment.edges.size(), false);
    garment.eased_triangle.assign(mesh.triangles.size(), false);
    for (const Triangle& t : mesh.triangles) {
        Mat2 e;
        e << garment.uv[t[1]] - garment.uv[t[0]], garment.uv[t[2]] - garment.uv[t[0]];
        garment.rest.edges.push_back(e);
    }
    return garment;
}

/// The same cloth cut along the line x = at (moved to vertices: a triangle belongs to the panel of its
/// centroid), the two panels with grains of their own, and sewn again: nodes shared, vertices not.
inline Garment cut_and_sewn(const FlatMesh& mesh, double at, double grain_left, double grain_right) {
    Garment garment = garment_of(mesh, grain_left);
    Mat2 turn;
    turn << std::cos(grain_right), -std::sin(grain_right), std::sin(grain_right), std::cos(grain_right);
    std::map<int, int> copy;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& tri = mesh.triangles[t];
        if ((mesh.points[tri[0]] + mesh.points[tri[1]] + mesh.points[tri[2]]).x() / 3 <= at) continue;
        garment.panel_of_triangle[t] = 1;
        for (int k = 0; k < 3; ++k) {
            const auto [found, fresh] = copy.emplace(tri[k], int(garment.uv.size()));
            if (fresh) {
                garment.uv.push_back(turn * (mesh.points[tri[k]] + Vec2(3, 1)));
                garment.panel_of_vertex.push_back(1);
                garment.node_of_vertex.push_back(tri[k]);
            }
            garment.triangles[t][k] = found->second;
        }
        const Triangle& v = garment.triangles[t];
        garment.rest.edges[t] << garment.uv[v[1]] - garment.uv[v[0]], garment.uv[v[2]] - garment.uv[v[0]];
    }
    garment.panel_names = {"left", "right"};
    garment.panel_fabrics = {"", ""};
    garment.panel_layers = {0, 0};
    return garment;
}

/// Node positions of a flat garment lying in the plane z = 0 as it was meshed.
inline Points flat_points(const FlatMesh& mesh) {
    Points points;
    for (const Vec2& p : mesh.points)
        points.push_back({p.x(), p.y(), 0});
    return points;
}

} // namespace toile::test
