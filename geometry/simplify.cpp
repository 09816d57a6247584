// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/simplify.h"

#include "geometry/solid.h"

#include <meshoptimizer.h>

#include <cmath>

namespace toile {

namespace {

double area(const TriMesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles)
        sum += 0.5 * (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]).norm();
    return sum;
}

} // namespace

TriMesh simplified(const TriMesh& mesh, double edge_length, double error) {
    const double wanted = area(mesh) / (std::sqrt(3.0) / 4 * edge_length * edge_length);
    if (double(mesh.triangles.size()) <= wanted) return mesh;
    std::vector<unsigned> corners, kept(3 * mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
    std::vector<float> places;
    for (const Vec3& p : mesh.points)
        for (const double c : p) places.push_back(float(c));
    const std::size_t stride = 3 * sizeof(float), count = mesh.points.size();
    const float share = float(error) / meshopt_simplifyScale(places.data(), count, stride);
    kept.resize(meshopt_simplify(kept.data(), corners.data(), corners.size(), places.data(), count, stride,
                                 3 * std::size_t(wanted), share, meshopt_SimplifyLockBorder, nullptr));
    TriMesh result{mesh.points, {}};
    for (std::size_t k = 0; k < kept.size(); k += 3)
        result.triangles.push_back({int(kept[k]), int(kept[k + 1]), int(kept[k + 2])});
    drop_unused_points(result);
    return result;
}

} // namespace toile
