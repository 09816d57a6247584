// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sewing/garment.h"

namespace toile {

/// Where the file puts every vertex of a level in space, metres.
Points place(const Pattern& pattern, const FlatLevel& flat);

} // namespace toile
