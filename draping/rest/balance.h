// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Forces of given places that hold given loads: linear, whatever the places are, and so solved without stepping.

#include "draping/energy/constraint.h"

namespace toile {

/// A function of points that cloth resists to change, such as the length of an edge or the angle of a hinge. With its
/// generalised force (J per unit of the function; positive pulls it down) it acts on its points by minus force times slope.
struct Member {
    int count = 0;
    std::array<int, 4> nodes{};
    std::array<Vec3, 4> slope;    ///< derivatives of the function by its nodes
    double stiffness = 0;         ///< J per square of the function, more than 0
    double low = 0, high = 0;     ///< bounds of the force, low <= 0 <= high
};

enum class BalanceEnd {
    balanced, ///< the forces hold the loads
    nearest,  ///< no forces within the bounds do: what is missing is the least sum of squares
    gave_up   ///< neither was reached
};

struct Balance {
    BalanceEnd end = BalanceEnd::gave_up;
    std::vector<double> force; ///< one per member, within its bounds
    Points missing;            ///< N per point: load and forces together; 0 where held
    int factorisations = 0;
};

/// Of all forces within the bounds that hold `load` (N per point) at the points that are not held, those of the least
/// sum of force^2 / stiffness; where there are none, of those with the least sum of squares of what is missing. `tolerance`:
/// what may be missing at a point, as a share of the largest load on a free one.
///
/// With all members inside their bounds the force is stiffness slope . u, u the displacement under the load of linear
/// elasticity: one sparse Cholesky of a matrix like that of the cloth. Bounds by the dual of the problem with weak springs to
/// every point, a semismooth Newton method in u (Qi and Sun, A nonsmooth version of Newton's method, 1993).
Balance balance(const std::vector<Member>& members, const Points& load, const std::vector<char>& held,
                double tolerance = 1e-9);

} // namespace toile
