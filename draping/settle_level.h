// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A level brought to rest, and what other stages that bring cloth to rest share with it. Internal to the stages of a
// drape.

#include "draping/drape_run.h"

namespace toile {

inline constexpr double soft_limit = 0.7; ///< turn of the strain limits' barrier that cloth beyond them can meet
inline constexpr double hard_limit = 0.9; ///< and the one to end with, hardened further where the cloth needs it

/// What acts on a closed garment at every level beside cloth, contact and weight: pins, bands, hooks that
/// stay and stitches that cannot become shared nodes.
void add_fixtures(DrapeRun& run, ClothProblem& problem);

/// Softens the membrane, and bands with the cloth, which they would crumple otherwise.
void soften(const DrapeRun& run, ClothProblem& problem, Loads& loads, double softness);

/// Books that the hooks of edges that carry are let go, and at what height.
void note_release(DrapeRun& run);

/// Books what acts and touches at the end.
void note_facts(DrapeRun& run, const Loads& loads, const TouchFacts& touch);

/// Says where a drape that has not converged is held up: too little cloth, what blocks the step, or the worst
/// force.
void note_where(DrapeRun& run, const ClothProblem& problem, SettleEnd end, int worst_node);

/// Settles on where cloth at rest is beyond its limits: these are hardened, and where the coordinates' last
/// digits no longer tell the forces of harder ones, or the cloth does not come to rest between them and the body,
/// drawn in by what the cloth is beyond them.
SettleResult settle_within_limits(DrapeRun& run, ClothProblem& problem, Cholesky& factor, const SettleOptions& o,
                                  SettleResult r);

/// Brings the level at work to rest: softened membrane first, whose longer steps find the lower drape. The
/// last level gives the result its status, and says where it is held up if it has not converged.
void settle_level(DrapeRun& run);

/// Whether the garment was sewn with neither labelled edges nor pins to carry it.
bool nothing_carries(const DrapeRun& run);

} // namespace toile
