// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/rest_mesh.h"

#include <algorithm>

namespace toile {

namespace {

/// Lengths from the start of the edge to each of its points.
std::vector<double> lengths_along(const RestMesh& rest, int edge) {
    const std::vector<int>& points = rest.edges[edge];
    std::vector<double> at{0};
    for (std::size_t k = 1; k < points.size(); ++k)
        at.push_back(at.back() + (rest.mesh.points[points[k]] - rest.mesh.points[points[k - 1]]).norm());
    return at;
}

} // namespace

std::vector<double> fractions_along(const RestMesh& rest, int edge) {
    std::vector<double> at = lengths_along(rest, edge);
    for (double& a : at) a /= length_along(rest, edge);
    at.back() = 1;
    return at;
}

Vec3 place_along(const RestMesh& rest, int edge, double t) {
    const std::vector<double> at = fractions_along(rest, edge);
    const std::vector<int>& points = rest.edges[edge];
    const auto next = std::clamp<std::size_t>(std::upper_bound(at.begin(), at.end(), t) - at.begin(), 1, at.size() - 1);
    const double share = (t - at[next - 1]) / (at[next] - at[next - 1]);
    return (1 - share) * rest.mesh.points[points[next - 1]] + share * rest.mesh.points[points[next]];
}

double length_along(const RestMesh& rest, int edge) { return lengths_along(rest, edge).back(); }

} // namespace toile
