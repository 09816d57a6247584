// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/energy/energy.h"

#include <limits>

namespace toile {

/// A function of at most four nodes that is wished to be 0, at an energy of 1/2 stiffness value^2; its force is cut at
/// stiffness value = cap.
struct Constraint {
    int count = 0;
    std::array<int, 4> nodes{};
    double value = 0;
    std::array<Vec3, 4> gradient;
    double stiffness = 0; ///< J per square of the value
    double cap = std::numeric_limits<double>::infinity(); ///< J per value
};

/// A model of cloth that is a sum of such energies, which methods that work position by position need.
class ConstraintEnergy : public Energy {
public:
    virtual int constraint_count() const = 0;
    virtual Constraint constraint(int k, const Points& x) const = 0; ///< at x
};

} // namespace toile
