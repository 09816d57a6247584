// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A disc with a sector cut out and its cut sewn up.

#include "tests/support/flat_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace toile::test {

struct Sector {
    static constexpr double inner = 0.05, outer = 0.2; ///< m, the tip is cut off: no sheet of paper has one
    Garment garment;                                   ///< sewn
    std::vector<Vec2> polar; ///< per node: angle in the flat sector, logarithm of radius / inner
};

/// (angle, log radius) to the plane keeps angles, so that the triangles stay well shaped. `angle` in rad,
/// `edge` as a share of the radius.
inline Sector sewn_sector(double angle, std::uint64_t seed, double edge = 0.08) {
    const double height = std::log(Sector::outer / Sector::inner);
    const FlatMesh strip = jittered_rectangle(angle, height, edge, 0.25, seed);
    FlatMesh flat = strip;
    for (Vec2& p : flat.points)
        p = Sector::inner * std::exp(p.y()) * Vec2(std::cos(p.x()), std::sin(p.x()));
    Garment open = garment_of(flat);
    for (int a = 0; a < open.node_count; ++a)
        for (int b = 0; b < open.node_count; ++b)
            if (strip.points[a].x() < 1e-9 && strip.points[b].x() > angle - 1e-9 &&
                std::abs(strip.points[a].y() - strip.points[b].y()) < 1e-9)
                open.stitches.push_back({b, {a, a}, 0, 0, 0.01});
    std::vector<int> node;
    Sector s{close_seams(open, &node), {}};
    s.polar.resize(s.garment.node_count);
    for (int i = open.node_count - 1; i >= 0; --i)
        s.polar[node[i]] = strip.points[i];
    return s;
}

/// Angles to the axis, degrees, of the straight lines from the inner rim to the outer one; none when the rims
/// do not have as many nodes.
inline std::vector<double> generator_angles(const Sector& s, const Points& x) {
    std::vector<std::pair<double, int>> rim[2];
    Vec3 centre[2] = {Vec3::Zero(), Vec3::Zero()};
    for (int i = 0; i < int(x.size()); ++i)
        for (int k = 0; k < 2; ++k)
            if (std::abs(s.polar[i].y() - k * std::log(Sector::outer / Sector::inner)) < 1e-9) {
                rim[k].emplace_back(s.polar[i].x(), i);
                centre[k] += x[i];
            }
    if (rim[0].size() != rim[1].size()) return {};
    const Vec3 axis = (centre[1] - centre[0]).normalized();
    for (auto& r : rim)
        std::sort(r.begin(), r.end());
    std::vector<double> angles;
    for (std::size_t k = 0; k < rim[0].size(); ++k) {
        const Vec3 along = (x[rim[1][k].second] - x[rim[0][k].second]).normalized();
        angles.push_back(std::acos(along.dot(axis)) * 180 / std::numbers::pi);
    }
    return angles;
}

/// A start of the wrong half angle (degrees), with rings too long or too short, and rough.
inline Points rough_cone(const Sector& s, double angle, double half_angle) {
    const double start = half_angle * std::numbers::pi / 180;
    Random random(9);
    Points x;
    for (const Vec2& p : s.polar) {
        const double round = 2 * std::numbers::pi * p.x() / angle, slant = Sector::inner * std::exp(p.y());
        x.push_back(slant * Vec3(std::sin(start) * std::cos(round), -std::cos(start),
                                 std::sin(start) * std::sin(round)) +
                    random.vec3(5e-4));
    }
    return x;
}

} // namespace toile::test
