// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// settle() by the nodes of a garment, whatever points the model of its cloth has of its own.

#include "draping/cloth.h"
#include "draping/solve/take_up.h"

namespace toile {

/// Whether the model has points beside the nodes (see Energy).
bool has_own_points(const ClothProblem& problem);

/// settle() from `nodes`, which are where the cloth is whenever options.progress is called.
SettleResult settle_cloth(ClothProblem& problem, Points& nodes, Cholesky& factor, SettleOptions options);

/// The same until constraints are kept, with `settle` in the place of settle_cloth().
SettleResult settle_constrained(ClothProblem& problem, Points& nodes, const SettleOptions& options,
                                const std::function<SettleResult(const SettleOptions&)>& settle);

} // namespace toile
