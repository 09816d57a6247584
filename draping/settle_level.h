// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A level with closed seams brought to rest. Internal to the stages of a drape.

#include "draping/drape_run.h"

namespace toile {

/// Brings the level at work to rest: softened membrane first, whose longer steps find the lower drape. The
/// last level gives the result its status, and says where it is held up if it has not converged.
void settle_level(DrapeRun& run);

} // namespace toile
