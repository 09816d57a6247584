// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A body that was drawn in and grows back, pushing the cloth ahead of it under the guarantee of contact.

#include "draping/cloth.h"
#include "draping/solve/settle.h"

namespace toile {

inline constexpr int grow_patience = 10; ///< rounds in which a body has to come nearer to its full size

/// How far points are from as many others at most, m.
double farthest(const Points& a, const Points& b);

/// The barriers while a body grows, in place of those of cloth at rest: the body's reaches farther, for the farther it
/// does, the farther cloth is pushed along in a round.
ContactOptions while_growing(const ContactOptions& at_rest);

/// Moves the body of the problem's contact on straight lines from where it is to `full` (as many points), in rounds of
/// a step that leaves nothing crossed and some iterations of the cloth: `settle` makes these on x with the options that
/// it is given, and returns whether to go on. Ends early when in `patience` rounds the body has come no nearer.
/// Returns how far its farthest point is from there, m; 0: it got there.
double grow_body(ClothProblem& problem, const Points& full, const Points& x, int patience,
                 const std::function<bool(const SettleOptions&)>& settle);

} // namespace toile
