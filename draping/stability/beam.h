// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace toile {

/// Of the slowest motion of a beam clamped at one end: the first root of 1 + cos x cosh x. Its frequency is root^2 sqrt(B / (rho L^4)).
inline constexpr double beam_root = 1.8751040687;

/// Its shape at s in [0, 1] of the length: 0 at the clamp, 2 at the free end.
inline double beam_mode(double s) {
    const double ratio = (std::cosh(beam_root) + std::cos(beam_root)) / (std::sinh(beam_root) + std::sin(beam_root));
    return std::cosh(beam_root * s) - std::cos(beam_root * s) - ratio * (std::sinh(beam_root * s) - std::sin(beam_root * s));
}

} // namespace toile
