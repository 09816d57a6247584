// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patterns/pattern.h"

namespace toile::test {

/// A closed loop of straight edges.
inline Loop polygon(const std::vector<Vec2>& p) {
    Loop loop;
    for (std::size_t i = 0; i < p.size(); ++i)
        loop.push_back({p[i], p[(i + 1) % p.size()], Straight{}, {}});
    return loop;
}

} // namespace toile::test
