// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/types.h"

#include <cstdint>

namespace toile::test {

/// The same numbers on every machine and library, unlike those of <random>'s distributions. SplitMix64.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    std::uint64_t bits() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    }
    /// Uniform in [0, 1).
    double unit() { return double(bits() >> 11) * 0x1p-53; }
    double in(double low, double high) { return low + (high - low) * unit(); }
    /// Uniform in [0, n).
    int below(int n) { return int(bits() % std::uint64_t(n)); }
    /// Uniform in the cube [-r, r]^3.
    Vec3 vec3(double r = 1) {
        const double x = in(-r, r), y = in(-r, r), z = in(-r, r);
        return {x, y, z};
    }

private:
    std::uint64_t state_;
};

} // namespace toile::test
