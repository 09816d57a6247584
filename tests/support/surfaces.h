// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Surfaces with known measures.

#include "geometry/tri_mesh.h"

#include <cmath>

namespace toile::test {

/// Closed ellipsoid about the origin with the given half axes; y is up. `around` >= 3, `along` >= 2.
/// 2 * around * (along - 1) triangles, outside counter-clockwise.
inline TriMesh ellipsoid(const Vec3& half, int around, int along) {
    TriMesh m;
    for (int j = 1; j < along; ++j)
        for (int i = 0; i < around; ++i) {
            const double theta = EIGEN_PI * j / along, phi = 2 * EIGEN_PI * i / around;
            m.points.push_back({half[0] * std::sin(theta) * std::cos(phi), half[1] * std::cos(theta),
                                half[2] * std::sin(theta) * std::sin(phi)});
        }
    const int top = int(m.points.size()), bottom = top + 1;
    m.points.push_back({0, half[1], 0});
    m.points.push_back({0, -half[1], 0});
    const auto at = [&](int j, int i) { return (j - 1) * around + i % around; };
    for (int i = 0; i < around; ++i) {
        m.triangles.push_back({top, at(1, i + 1), at(1, i)});
        m.triangles.push_back({bottom, at(along - 1, i), at(along - 1, i + 1)});
        for (int j = 1; j + 1 < along; ++j) {
            m.triangles.push_back({at(j, i), at(j, i + 1), at(j + 1, i)});
            m.triangles.push_back({at(j + 1, i), at(j, i + 1), at(j + 1, i + 1)});
        }
    }
    return m;
}

/// Open tube about the y axis, y from 0 to `height`, whose radius waves by `wave`; 2 * around * along
/// triangles, outside counter-clockwise. Point j * around + i is at height j / along.
inline TriMesh tube(double radius, double height, int around, int along, double wave = 0) {
    TriMesh m;
    for (int j = 0; j <= along; ++j)
        for (int i = 0; i < around; ++i) {
            const double phi = 2 * EIGEN_PI * i / around;
            const double r = radius + wave * std::sin(7 * phi);
            m.points.push_back({r * std::cos(phi), height * j / along, r * std::sin(phi)});
        }
    const auto at = [&](int j, int i) { return j * around + i % around; };
    for (int j = 0; j < along; ++j)
        for (int i = 0; i < around; ++i) {
            m.triangles.push_back({at(j, i), at(j + 1, i), at(j, i + 1)});
            m.triangles.push_back({at(j + 1, i), at(j + 1, i + 1), at(j, i + 1)});
        }
    return m;
}

/// Flat grid in the plane z = `z`, nx * ny squares of the given size, front to +z. Point j * (nx + 1) + i.
inline TriMesh grid(int nx, int ny, double size, double z = 0) {
    TriMesh m;
    for (int j = 0; j <= ny; ++j)
        for (int i = 0; i <= nx; ++i)
            m.points.push_back({i * size, j * size, z});
    const auto at = [&](int j, int i) { return j * (nx + 1) + i; };
    for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) {
            m.triangles.push_back({at(j, i), at(j, i + 1), at(j + 1, i + 1)});
            m.triangles.push_back({at(j, i), at(j + 1, i + 1), at(j + 1, i)});
        }
    return m;
}

} // namespace toile::test
