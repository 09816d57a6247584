// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Whether two moving simplices touch, without rounding. Conservative advancement (geometry/toi.h) cannot tell
// touching from nearly touching below rounding; this can, in some 50 microseconds instead of one.

#include "geometry/toi.h"

#include <optional>

namespace toile {

enum class PairKind { point_triangle, edge_edge };

/// Whether two simplices touch at any t in [0, 1] while their corners move linearly, in exact integer and
/// algebraic arithmetic (GMP): no tolerance and no rounding, degenerate simplices and motions included.
/// Corners as in geometry/toi.h. All numbers must be finite.
bool exactly_touch(PairKind kind, const Motion& m); ///< corner k moves from x[k] to x[k] + dx[k], not rounded
bool exactly_touch(PairKind kind, const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to);

/// A time in [0, 1), not later than the first contact, of a pair that touches while it moves; nothing for one that
/// does not. The time is that of conservative advancement by `options`, and exact arithmetic is asked only where that
/// says that the pair comes as near as they say: the nearer, the less often. A motion that is not finite touches.
std::optional<double> time_of_contact(PairKind kind, const Motion& m, const ToiOptions& options);
std::optional<double> time_of_contact(PairKind kind, const std::array<Vec3, 4>& from, const std::array<Vec3, 4>& to,
                                      const ToiOptions& options);

} // namespace toile
