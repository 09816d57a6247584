// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Lengths that are kept exactly. A triangle keeps its shape when the three distances between the midpoints of
// its edges do: three conditions per triangle, those of F^T F = I.

#include "sewing/garment.h"

namespace toile {

/// c = (|x_a - x_b|^2 - length^2) / (2 length) = 0: quadratic, so that first derivatives are linear in x and
/// second ones constant. c is in metres, to first order how much too long the bar is; its multiplier is the
/// bar's tension in N.
struct Bar {
    int a = 0, b = 0;
    double length = 0; ///< m, > 0
};
using Bars = std::vector<Bar>;

/// Three bars per triangle, between midpoints numbered as Garment::edges. Bar 3 t + k lies opposite the
/// midpoint of edge k of triangle t and is half that edge long. Throws std::invalid_argument for a triangle
/// without area.
Bars triangle_bars(const Garment& garment);

/// c per bar.
Eigen::VectorXd misfit(const Bars& bars, const Points& x);

/// Largest |c| / length: the largest strain of a bar, to first order.
double largest_strain(const Bars& bars, const Points& x);

/// Largest principal strain of a triangle, in absolute value, by the singular values of F. `bars` as
/// triangle_bars() makes them; works from positions alone and shares nothing with the conditions that are
/// solved.
double largest_triangle_strain(const Garment& garment, const Points& midpoints);

/// Adds J^T lambda: the forces of bars with those tensions, as a gradient.
void add_tensions(const Bars& bars, const Points& x, const Eigen::VectorXd& lambda, Eigen::VectorXd& g);

/// J d, d with three entries per point.
Eigen::VectorXd lengthening(const Bars& bars, const Points& x, const Eigen::VectorXd& d);

} // namespace toile
