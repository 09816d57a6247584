// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The textbook test for the collision of two moving simplices, to compare with: roots of the cubic that says
// when four linearly moving points are coplanar, then whether the contact lies inside (Provot, Collision and
// self-collision handling in cloth model dedicated to design garments, 1997; Bridson, Fedkiw, Anderson,
// Robust treatment of collisions, contact and friction for cloth animation, 2002). Draping does not use it:
//
//  * Rounding of the coefficients loses roots, or moves them out of the step. Where two simplices touch
//  without
//    passing through each other (a double root), the smallest error leaves no root at all.
//  * Motion within one plane has a cubic of zeros, whose roots say nothing: only both ends of the step are
//  looked at.
//  * No tolerance is right. With none, contacts on edges and corners are lost; with one, what passes beside
//  them
//    counts as contact, and a root that was lost stays lost.
//  * It keeps no distance: what it calls the time of contact may be just after it.
//
// docs/collisions.md counts what it misses; geometry/toi.h misses nothing.

#include "geometry/toi.h"

#include <optional>

namespace toile {

/// The earliest root in [0, 1] at which the contact lies inside of both simplices, by up to `tolerance`
/// (metres, measured along their edges) outside of them; nothing when none was found, which does not prove
/// that there is none.
std::optional<double> cubic_toi_point_triangle(const Motion& m, double tolerance); ///< x = p, a, b, c
std::optional<double> cubic_toi_edge_edge(const Motion& m, double tolerance);      ///< x = a0, a1, b0, b1

} // namespace toile
