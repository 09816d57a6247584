// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Cloth that is not flat at rest, and how it comes to rest.

#include "draping/cloth.h"
#include "draping/rest/moulded.h"
#include "draping/solve/settle.h"
#include "tests/support/flat_mesh.h"
#include "tests/support/mesh_cloth.h"

#include <cmath>
#include <functional>
#include <numbers>

namespace toile::test {

/// Disc of unit radius with `rings` rings of points, six more on each, moved by up to `jitter` of their distance.
inline FlatMesh disc(int rings, double jitter, std::uint64_t seed) {
    Random random(seed);
    FlatMesh mesh;
    mesh.points.push_back({0, 0});
    for (int j = 1; j <= rings; ++j)
        for (int i = 0; i < 6 * j; ++i) {
            const double angle = 2 * std::numbers::pi * i / (6 * j), edge = jitter / rings;
            const Vec2 at = double(j) / rings * Vec2(std::cos(angle), std::sin(angle));
            mesh.points.push_back(j == rings ? at : Vec2(at + Vec2(random.in(-edge, edge), random.in(-edge, edge))));
        }
    mesh.triangles = delaunay(mesh.points);
    return mesh;
}

/// A flat mesh pressed to the surface that `form` gives over it, at rest there.
inline Cloth pressed(const FlatMesh& mesh, const std::function<Vec3(const Vec2&)>& form, double grain = 0) {
    Cloth c{garment_of(mesh, grain), {}};
    for (const Vec2& p : mesh.points) c.x.push_back(form(p));
    c.garment.rest = moulded(c.garment, c.x);
    return c;
}

/// A mesh of any surface, the weft of every triangle along its first edge.
inline Cloth moulded_mesh(const TriMesh& mesh) {
    Cloth cloth = cloth_of(mesh);
    cloth.garment.rest.angles.assign(cloth.garment.edges.size(), 0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& n = mesh.triangles[t];
        const Vec3 a = cloth.x[n[1]] - cloth.x[n[0]], b = cloth.x[n[2]] - cloth.x[n[0]];
        cloth.garment.rest.edges[t] << a.norm(), b.dot(a) / a.norm(), 0, a.cross(b).norm() / a.norm();
    }
    cloth.garment.rest = moulded(cloth.garment, cloth.x);
    return cloth;
}

/// Alike in all directions, without lateral contraction and as stiff pushed as pulled; `stretch` in N/m, `bend` in N m.
inline Fabric isotropic(double stretch, double bend) {
    Fabric f;
    f.name = "isotropic";
    f.density = 1e-5;
    f.stretch_warp = f.stretch_weft = stretch;
    f.shear = stretch / 2;
    f.compression = 1;
    f.bend_warp = f.bend_weft = bend;
    f.bend_twist = bend / 2;
    return f;
}

inline FreeCloth free_cloth(const Garment& garment, const Fabric& fabric) {
    return {std::make_unique<SheetEnergy>(make_sheet(garment, {fabric})), node_masses(garment, {fabric})};
}

inline bool comes_to_rest(FreeCloth& cloth, Points& x, double tolerance, int iterations = 1000) {
    Cholesky factor;
    SettleOptions options;
    options.tolerance = tolerance;
    options.max_iterations = iterations;
    return settle(cloth, x, factor, options).end == SettleEnd::settled;
}

} // namespace toile::test
