// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Friction of cloth on cloth: every pair that touches ties the two places of the cloth that are nearest to each other.
// What acts on one is taken from the other, and since a tie has the nodes of its pair, a cloth that lies between two
// others is held by each, and the matrix of contact has every block that friction needs. A pair that begins to touch is
// tied where it is, with the little force that it has then; so friction goes on as what slides passes from one triangle
// to the next.

#include "draping/contact/contact.h"
#include "draping/contact/friction.h"

namespace toile {

/// Makes the ties of `friction` those of `forces`, sorted like them: lets go what touches no longer and ties what is new,
/// without a force yet. The others turn with their pair from `before` to `x`, so that cloth in layers may bend and turn
/// as a whole, and are anchored anew where they have slid far.
void match_ties(Friction& friction, const std::vector<PairForce>& forces, const Points& before, const Points& x);

/// Puts ties in the order that match_ties() keeps.
void sort_ties(Friction& friction);

/// Places the ties on the body (one per node) and of the cloth, whose normal forces are known, such that friction comes
/// as near as it can to the forces `g` (3 per node, N), which a state at rest leaves when friction is left out; `g`
/// receives what is left over. The state came to rest with the normals of a few steps before: a normal of the body
/// within 30 degrees that leaves no force over is taken for the one it had.
void take_up(Friction& body, Friction& cloth, const Points& x, const std::vector<char>& pinned, Eigen::VectorXd& g);

} // namespace toile
