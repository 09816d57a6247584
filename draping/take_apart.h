// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A start of a level that contact can take: cloth that crosses neither itself nor the body. Internal to the
// stages of a drape.

#include "draping/drape_run.h"

namespace toile {

/// Takes the cloth apart unless that would push it into the body; what then still crosses is left out of
/// contact, and false returned.
bool take_apart_or_leave_out(DrapeRun& run, Contact& contact);

/// Draws the body in until the cloth is clear of it, and lets it grow back under contact. Fine triangles cut
/// the creases and curves of the coarse ones they come from, by a millimetre or so. `run.result.drawn_in`
/// tells by how much the body did not get back to its full size.
void clear_of_body(DrapeRun& run, ClothProblem& problem, Cholesky& factor);

} // namespace toile
