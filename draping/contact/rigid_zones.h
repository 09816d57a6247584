// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Rigid impact zones: nodes that meet are moved on as one rigid body, and zones that meet are joined, until nothing
// meets. Provot: Collision and self-collision handling in cloth model dedicated to design garments, 1997, with the
// inertia of Bridson, Fedkiw and Anderson 2002. Points of the body, and pinned nodes, carry their zone along: it
// moves as they do, and is welded to what it touches.

#include "draping/contact/impacts.h"

namespace toile {

/// Corrects the velocities of a step until no pair meets or `rounds` are over; notes zones, their nodes, and how many of
/// the impacts that are left touch, in `done`. A rigid motion written as x + dt (v + w cross r) brings no two points of a zone
/// nearer to each other, so the linear motions of a step keep what it promises. What the body does in a step need not
/// be rigid; then impacts may be left.
void resolve_by_zones(StepPairs& pairs, const ResponseStep& step, Points& v, int rounds, ResponseDone& done);

} // namespace toile
