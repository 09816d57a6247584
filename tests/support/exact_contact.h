// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The truth about a motion, in exact arithmetic: the slow twin of geometry/toi.h and geometry/toi_cubic.h.

#include "geometry/toi.h"

namespace toile::test {

enum class PairKind { point_triangle, edge_edge };

/// Whether two simplices touch at any t in [0, 1] while their corners move linearly, in exact integer and
/// algebraic arithmetic (GMP): no tolerance and no rounding, degenerate simplices and motions included.
/// Corners as in geometry/toi.h. All numbers must be finite. Some 50 microseconds where the coplanarity cubic
/// has roots.
bool exactly_touch(PairKind kind, const Motion& m); ///< corner k moves from x[k] to x[k] + dx[k], not rounded
bool exactly_touch(PairKind kind, const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to);

} // namespace toile::test
