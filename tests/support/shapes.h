// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/tri_mesh.h"

#include <cmath>
#include <map>

namespace toile::test {

/// A closed box of 12 triangles, facing outward.
inline TriMesh box(const Vec3& low, const Vec3& high) {
    TriMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.points.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
    const int quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& q : quads) {
        mesh.triangles.push_back({q[0], q[1], q[2]});
        mesh.triangles.push_back({q[0], q[2], q[3]});
    }
    return mesh;
}

/// A sphere about the origin: an octahedron whose triangles are split in four `rounds` times.
inline TriMesh sphere(double radius, int rounds) {
    TriMesh mesh;
    mesh.points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int round = 0; round < rounds; ++round) {
        std::map<std::array<int, 2>, int> middles;
        const auto middle = [&](int a, int b) {
            const auto [it, is_new] = middles.try_emplace({std::min(a, b), std::max(a, b)}, int(mesh.points.size()));
            if (is_new) mesh.points.push_back((mesh.points[a] + mesh.points[b]).normalized());
            return it->second;
        };
        std::vector<Triangle> finer;
        for (const Triangle& t : mesh.triangles) {
            const int a = middle(t[1], t[2]), b = middle(t[2], t[0]), c = middle(t[0], t[1]);
            finer.insert(finer.end(), {{t[0], c, b}, {c, t[1], a}, {b, a, t[2]}, {a, b, c}});
        }
        mesh.triangles = finer;
    }
    for (Vec3& p : mesh.points) p *= radius;
    return mesh;
}

} // namespace toile::test
