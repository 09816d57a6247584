// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/sheet_mesh.h"

#include "geometry/random.h"
#include "patterns/triangulate.h"
#include "sewing/mesh_grain.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace toile {

namespace {

SheetMesh of_panel(double length, double width, double edge) {
    Panel panel;
    panel.name = "sheet";
    const std::array<Vec2, 4> corners{{{0, 0}, {length, 0}, {length, width}, {0, width}}};
    for (int k = 0; k < 4; ++k) panel.outline.push_back({corners[k], corners[(k + 1) % 4], Straight{}, ""});
    Pattern pattern;
    pattern.panels = {panel};
    TriangulateOptions options;
    options.edge_length = edge;
    const FlatPattern flat = triangulate(pattern, options);
    return {flat.levels.back().points, flat.levels.back().triangles};
}

} // namespace

SheetMesh halved_rectangles(MeshKind kind, double length, double width, int along, int up) {
    SheetMesh mesh;
    for (int j = 0; j <= up; ++j)
        for (int i = 0; i <= along; ++i) mesh.points.push_back({length * i / along, width * j / up});
    for (int j = 0; j < up; ++j)
        for (int i = 0; i < along; ++i) {
            const int a = j * (along + 1) + i, b = a + 1, c = b + along + 1, d = c - 1;
            if (kind == MeshKind::alternating && (i + j) % 2 == 1)
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
            else
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
        }
    return mesh;
}

SheetMesh sheet_mesh(MeshKind kind, double length, double width, double edge) {
    if (kind == MeshKind::unstructured) return of_panel(length, width, edge);
    return halved_rectangles(kind, length, width, std::max(1, int(std::lround(length / edge))), std::max(1, int(std::lround(width / edge))));
}

SheetMesh jittered(SheetMesh mesh, double share, unsigned seed) {
    std::vector<double> shortest(mesh.points.size(), INFINITY);
    std::map<std::array<int, 2>, int> sides; // of every edge
    for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) {
            const int a = t[k], b = t[(k + 1) % 3];
            ++sides[{std::min(a, b), std::max(a, b)}];
            const double length = (mesh.points[b] - mesh.points[a]).norm();
            shortest[a] = std::min(shortest[a], length);
            shortest[b] = std::min(shortest[b], length);
        }
    for (const auto& [ends, count] : sides)
        if (count == 1) shortest[ends[0]] = shortest[ends[1]] = 0; // on the border
    std::mt19937_64 random(seed);
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const double x = next_signed(random), y = next_signed(random);
        mesh.points[i] += share * shortest[i] * Vec2(x, y);
    }
    return mesh;
}

SheetMesh with_mirror_image(const SheetMesh& half) {
    SheetMesh both = half;
    std::vector<int> twin;
    for (const Vec2& p : half.points) {
        const bool on_line = p.x() < 1e-12;
        twin.push_back(on_line ? int(twin.size()) : int(both.points.size()));
        if (!on_line) both.points.push_back({-p.x(), p.y()});
    }
    for (const Triangle& t : half.triangles) both.triangles.push_back({twin[t[0]], twin[t[2]], twin[t[1]]});
    return both;
}

Garment sheet_garment(const SheetMesh& mesh) {
    std::vector<Mat2> edges;
    for (const Triangle& t : mesh.triangles) {
        const Vec2 a = mesh.points[t[1]] - mesh.points[t[0]], b = mesh.points[t[2]] - mesh.points[t[0]];
        Mat2 e; // rows are weft and warp: a quarter turn from (x, y), with the same orientation
        e << -a.y(), -b.y(), a.x(), b.x();
        edges.push_back(e);
    }
    return mesh_garment(mesh.triangles, int(mesh.points.size()), std::move(edges));
}

} // namespace toile
