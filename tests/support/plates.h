// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Plates with known answers: what a bending element is judged by.

#include "tests/support/flat_mesh.h"

#include <Eigen/Core>

#include <cmath>
#include <numbers>

namespace toile::test {

/// For every point of a mirrored mesh with x < 0 its twin with x > 0, itself otherwise.
inline std::vector<int> twins(const std::vector<Vec2>& points) {
    std::map<std::array<long long, 2>, int> right;
    const auto key = [](double x, double y) {
        return std::array<long long, 2>{std::llround(x * 1e9), std::llround(y * 1e9)};
    };
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points[i].x() >= -1e-12) right[key(points[i].x(), points[i].y())] = int(i);
    std::vector<int> twin;
    for (std::size_t i = 0; i < points.size(); ++i)
        twin.push_back(points[i].x() >= -1e-12 ? int(i) : right.at(key(-points[i].x(), points[i].y())));
    return twin;
}

/// The heavy elastica of unit length, clamped level at one end: phi'' = -gamma (1 - s) cos(phi), phi(0) =
/// phi'(1) = 0, phi downward. Points at s = i / n, i = 0 .. n: x and depth.
inline std::vector<Vec2> elastica(double gamma, int n = 4000) {
    const double h = 1.0 / n;
    // From the free end, t = 1 - s, for a trial angle there; Runge-Kutta of fourth order.
    const auto angles = [&](double tip) {
        std::vector<double> phi{tip};
        double y = tip, v = 0;
        const auto pull = [&](double t, double a) { return -gamma * t * std::cos(a); };
        for (int i = 0; i < n; ++i) {
            const double t = i * h;
            const double k1 = pull(t, y), k2 = pull(t + h / 2, y + h / 2 * v);
            const double k3 = pull(t + h / 2, y + h / 2 * (v + h / 2 * k1)),
                         k4 = pull(t + h, y + h * (v + h / 2 * k2));
            y += h * (v + h / 6 * (k1 + k2 + k3));
            v += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
            phi.push_back(y);
        }
        return phi;
    };
    double low = 0, high = std::numbers::pi / 2; // the root's angle grows with the tip's
    for (int i = 0; i < 100; ++i) {
        const double middle = (low + high) / 2;
        (angles(middle).back() < 0 ? low : high) = middle;
    }
    std::vector<double> phi = angles(high);
    std::reverse(phi.begin(), phi.end());
    std::vector<Vec2> points{{0, 0}};
    for (int i = 0; i < n; ++i) {
        const double a = (phi[i] + phi[i + 1]) / 2;
        points.push_back(points.back() + h * Vec2(std::cos(a), std::sin(a)));
    }
    return points;
}

} // namespace toile::test
