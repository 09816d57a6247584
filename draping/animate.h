// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A garment let go where it is sewn: its motion in real time, recorded at equal times. Internal to the stages of a drape.

#include "draping/drape_run.h"

namespace toile {

/// Brings the level at work to rest without weight, its edges that carry held by hooks: so it is sewn, and neither stretched
/// by the sewing nor has it fallen when its motion begins.
void rest_without_weight(DrapeRun& run);

/// Moves the last level from where it is, with the method and the response of the options, and records it: see
/// AnimateOptions. The hooks are let go and the weight sets in when the first frame has been recorded.
void animate(DrapeRun& run);

} // namespace toile
