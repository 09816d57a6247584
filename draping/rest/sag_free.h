// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Rest lengths and angles with which a surface hangs as it was modelled: inverse statics of shells and rods (Twigg and
// Kacic-Alesic, Optimization for Sag-Free Simulations, 2011; Derouet-Jourdan and others, Stable Inverse Dynamic Curves, 2010).
// Derivation and figures: docs/rest.md.

#include "draping/rest/balance.h"
#include "draping/rest/prescribed.h"

namespace toile {

struct SagFreeOptions {
    double length_change = 0.05;    ///< most change of a rest length, as a share of the measured one, [0, 0.5]
    double angle_change = M_PI / 2; ///< most change of a rest angle, rad, [0, pi]; no angle goes beyond half a turn
    double tolerance = 1e-9;        ///< what may be missing at a point, as a share of the largest load on a free one
};

struct SagFree {
    Prescribed rest;           ///< lengths and angles found, weights those given
    BalanceEnd end = BalanceEnd::gave_up;
    Points missing;            ///< N per point: the load that the cloth does not hold; 0 where held
    int worst = -1;            ///< the point that lacks most; -1: no free point
    std::vector<int> length_bounds, angle_bounds; ///< edges whose length or angle lies at its bound
    bool stable = false;       ///< whether the balance is one to which the cloth comes back
    int factorisations = 0;
};

/// The rest lengths and angles nearest to those that `x` has, in the sense of
///   sum of length_weight s^2 + angle_weight (theta0 - theta)^2,  s the change of a length as a share of it,
/// with which cloth of `data`'s triangles and weights (whose own lengths and angles do not count) is in balance at `x`
/// under `load` (N per point: weight, and whatever else pushes) but for the points that are `held`. Energies are those of
/// PrescribedEnergy: its gradient is linear in tensions and moments, which is what is solved for; s is tension |e| / (2
/// weight), the change to first order. Throws std::invalid_argument for a triangle without area, named by its points.
SagFree sag_free(const Prescribed& data, const Points& x, const Points& load, const std::vector<char>& held,
                 const SagFreeOptions& options = {});

/// The same for cloth of a fabric, whose weights are those that weigh() gives the rest shape found: found again with them until
/// they stay. Where lengths come out that no triangle has (impossible_triangle()) there are no such weights, and the search ends.
SagFree sag_free(const std::vector<Triangle>& triangles, const Points& x, const Fabric& fabric, const Points& load,
                 const std::vector<char>& held, const SagFreeOptions& options = {});

/// A third of the weight of a point's triangles as `x` has them, N, along -y; density in kg/m2, gravity in m/s2.
Points weight_of(const std::vector<Triangle>& triangles, const Points& x, double density, double gravity);

/// The lengths and angles of `data` as members, in the order of PrescribedEnergy, lengths first; those without weight too.
/// Forces are bounded by what the options allow.
std::vector<Member> members_of(const Prescribed& data, const Points& x, const SagFreeOptions& options = {});

/// The tension (N) of an edge of `length_weight` (J) that is `distance` long and wants to be `length`; and the length for
/// which it has a tension of at least -weight / (2 distance).
double tension_of(double weight, double distance, double length);
double length_for(double weight, double distance, double tension);

} // namespace toile
