// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The coarsest level, from where the file puts its panels to a garment with closed seams. Internal to the
// stages of a drape.

#include "draping/drape_run.h"

namespace toile {

/// Lays panels anew that lie far from what they are sewn to.
void lay(DrapeRun& run);

/// Places and sews the coarsest level: where the file puts the garment, else moved up or down as a whole to
/// where fewer threads pass through the body. The cloth may pass through itself on the way when it cannot
/// close otherwise; what counts is that the sewn garment does not cross itself. A seam that does not close
/// leaves `run.open`, with the status and the place in the result.
void sew_coarsest(DrapeRun& run);

} // namespace toile
