// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The barrier between two simplices: nothing at a distance, infinite at the floor.
// Li et al.: Incremental Potential Contact, 2020, with a pressure for its scale and a floor above zero.

#include "geometry/distance.h"

#include <Eigen/Core>

namespace toile {

/// Energy per area as a function of distance: stiffness * range^2 * phi((d - floor) / range),
/// phi(t) = -(1 - t)^2 log t, range = distance - floor. C2 where it begins to act.
struct Barrier {
    double distance = 0;  ///< m, acts below
    double floor = 0;     ///< m, infinite here
    double stiffness = 0; ///< Pa/m

    double energy(double d) const;
    double slope(double d) const;     ///< dE/dd, negative
    double curvature(double d) const; ///< d2E/dd2, positive
};

/// Four points of a pair (point-triangle or edge-edge) with signed weights: the vector between the nearest points
/// is sum weight_i x_i, its length is the distance.
struct PairGeometry {
    double d = 0;
    std::array<double, 4> weight{};
    Vec3 normal = Vec3::Zero(); ///< unit, from the second simplex to the first
    int active = 0;             ///< bit k: corner k takes part
};

PairGeometry pair_geometry(const std::array<Vec3, 4>& x, bool edge_edge);

/// Exact second derivative of the distance over the twelve coordinates, nearest features held.
Eigen::Matrix<double, 12, 12> distance_hessian(const std::array<Vec3, 4>& x, const PairGeometry& g, bool edge_edge);

/// Fades a pair of edges out as they become parallel, where their distance has a kink.
/// `scale` is the product of the squared rest lengths.
struct ParallelFade {
    double value = 1;
    std::array<Vec3, 4> gradient; ///< over a0, a1, b0, b1
    bool fading = false;          ///< false: value 1 and gradient 0
};
ParallelFade parallel_fade(const std::array<Vec3, 4>& x, double scale);

/// Second derivative of the fade's value over the twelve coordinates.
Eigen::Matrix<double, 12, 12> parallel_fade_hessian(const std::array<Vec3, 4>& x, double scale);

} // namespace toile
