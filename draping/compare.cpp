// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/compare.h"

#include "geometry/foot.h"
#include "geometry/parallel.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace toile {

namespace {

// Corners and centroids with the weights of the rule that integrates squares of linear functions over a
// triangle exactly: a twelfth of its area at each corner, three quarters at the centroid.
struct Samples {
    Points points;
    std::vector<double> weights;
};

Samples samples_of(const TriMesh& mesh, const std::vector<double>& areas) {
    Samples s;
    s.points = mesh.points;
    s.weights.assign(mesh.points.size(), 0);
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
        const auto& [a, b, c] = mesh.triangles[k];
        for (int i : mesh.triangles[k])
            s.weights[i] += areas[k] / 12;
        s.points.push_back((mesh.points[a] + mesh.points[b] + mesh.points[c]) / 3);
        s.weights.push_back(0.75 * areas[k]);
    }
    return s;
}

std::vector<double> areas_of(const TriMesh& mesh) {
    std::vector<double> areas;
    for (const Triangle& t : mesh.triangles) areas.push_back(triangle_area(mesh.points, t));
    return areas;
}

Points nearest_on(const TriMesh& mesh, const Bvh& tree, const Samples& samples) {
    Points nearest(samples.points.size());
    parallel_for(int(nearest.size()), 256, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) nearest[i] = foot_on(mesh, tree, samples.points[i]).at;
    });
    return nearest;
}

// Distances from samples to their partners. Points that no triangle uses have no weight and do not count.
Comparison distances(const Samples& from, const Points& to) {
    Comparison result;
    double area = 0, squares = 0, sum = 0;
    for (std::size_t i = 0; i < to.size(); ++i) {
        if (!(from.weights[i] > 0)) continue;
        const double d = (to[i] - from.points[i]).norm();
        area += from.weights[i];
        squares += from.weights[i] * d * d;
        sum += from.weights[i] * d;
        if (d > result.max) {
            result.max = d;
            result.where = from.points[i];
        }
    }
    if (area > 0) {
        result.rms = std::sqrt(squares / area);
        result.mean = sum / area;
    }
    return result;
}

void require_surface(const TriMesh& mesh, const char* which) {
    if (mesh.triangles.empty())
        throw std::invalid_argument(std::string("the ") + which +
                                    " mesh has no triangles, expected a surface");
    for (const Vec3& p : mesh.points)
        if (!p.allFinite())
            throw std::invalid_argument(std::string("the ") + which +
                                        " mesh has coordinates that are not finite");
}

} // namespace

Comparison compare(const TriMesh& a, const TriMesh& b) {
    require_surface(a, "first");
    require_surface(b, "second");
    const Samples from_a = samples_of(a, areas_of(a));
    if (a.points.size() == b.points.size() && a.triangles == b.triangles) {
        Comparison result = distances(from_a, samples_of(b, areas_of(b)).points);
        result.same_triangles = true;
        return result;
    }
    const Samples from_b = samples_of(b, areas_of(b));
    const Bvh tree_a(triangle_boxes(a.points, a.triangles, 0)),
        tree_b(triangle_boxes(b.points, b.triangles, 0));
    const Points on_a = nearest_on(a, tree_a, from_b);
    const Comparison ab = distances(from_a, nearest_on(b, tree_b, from_a)), ba = distances(from_b, on_a);
    Comparison result;
    result.rms = std::max(ab.rms, ba.rms);
    result.mean = std::max(ab.mean, ba.mean);
    result.max = std::max(ab.max, ba.max);
    result.where = ab.max >= ba.max ? ab.where : ba.where;
    return result;
}

} // namespace toile
