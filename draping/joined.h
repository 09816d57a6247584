// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Drapes that are done in more than one go.

#include "draping/drape.h"

namespace toile {

/// The result of the last go, `now`, with the levels and the seconds of all.
DrapeResult joined(DrapeResult before, DrapeResult now);

} // namespace toile
