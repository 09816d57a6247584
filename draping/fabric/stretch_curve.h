// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A measured curve of tension against strain: monotone cubics (Fritsch, Carlson: Monotone Piecewise Cubic Interpolation, 1980).

#include <string>
#include <vector>

namespace toile {

/// Of a strip pulled along the grain and free to contract.
struct StretchPoint {
    double stretch = 0; ///< by how much it is longer, as a share of its flat length
    double tension = 0; ///< N per metre of its flat width

    bool operator==(const StretchPoint&) const = default;
};

/// From `from` on, s = strain - from: tension + slope s + bend s^2 + twist s^3, up to the next piece.
struct CurvePiece {
    double from = 0, energy = 0, tension = 0, slope = 0, bend = 0, twist = 0;
};

/// Tension is once continuously differentiable and its integral, the energy, twice. The first slope is that of the first two
/// points, and holds below 0 too; beyond the last point the curve goes on straight with the slope of the last two. Empty: none.
struct StretchCurve {
    std::vector<CurvePiece> pieces;

    bool empty() const { return pieces.empty(); }
    double first_slope() const { return pieces.front().slope; }
};

/// Throws std::invalid_argument, in a sentence, for what are not two to 1000 finite points of which the first is (0, 0) and
/// both numbers rise from each to the next.
void check_points(const std::vector<StretchPoint>& points);

/// Tension (N/m) against stretch, through the points; empty for none. Throws as check_points().
StretchCurve stretch_curve(const std::vector<StretchPoint>& points);

/// The same points in the measure of a membrane, which is Green's strain e = s + s^2 / 2 and its stress, tension / (1 + s): a
/// straight line here is a membrane of constant stiffness. Throws as check_points(), and where that stress does not rise.
StretchCurve membrane_curve(const std::vector<StretchPoint>& points);

struct CurveState {
    double energy = 0;  ///< J/m2, from 0 to the strain
    double tension = 0; ///< N/m, its derivative
    double slope = 0;   ///< N/m, the derivative of that
};

CurveState evaluate(const StretchCurve& curve, double strain);

/// The same as shares of a straight line's: energy = 1/2 by_energy strain^2, tension = by_tension strain. All three are the first
/// slope at 0 and below.
struct CurveSecants {
    double by_energy = 0, by_tension = 0, slope = 0; ///< N/m
};

CurveSecants secants(const StretchCurve& curve, double strain);

/// The least slope anywhere, N/m.
double least_slope(const StretchCurve& curve);

} // namespace toile
