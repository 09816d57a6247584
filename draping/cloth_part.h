// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Most of a garment comes to rest long before the rest of it does: a sleeve still slides into its folds while the
// bodice hangs. What still moves is settled by itself, against what lies still, at the cost of its own size.

#include "draping/cloth.h"
#include "draping/solve/settle.h"

namespace toile {

/// A part of a cloth on its own: nodes that move, and around them what they act on, which stands still.
struct ClothPart {
    std::vector<int> nodes; ///< of the whole, rising: the part's node k is nodes[k] there
    std::unique_ptr<ClothProblem> problem;
};

/// The part of `whole`, a sheet, whose nodes are `moving` (1 each) and no farther than `travel` (m) from where x has them.
/// Up to a constant its energy is that of the whole, with the friction that the whole has.
ClothPart part_of(const ClothProblem& whole, const Points& x, const std::vector<char>& moving, double travel);

/// Settles the part of `whole`, a sheet, that the last `step` moved most, if that is a small part, for some iterations.
/// Every state on the way is feasible for the whole, and so is x afterwards. Returns the iterations.
int relax_part(ClothProblem& whole, Points& x, const Eigen::VectorXd& step, double residual, double travel,
               const SettleOptions& options);

} // namespace toile
