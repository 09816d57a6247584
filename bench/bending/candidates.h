// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The bending elements that were compared before the solver was built on one of them. Only what the
// comparison needs: isotropic plates without coupling (nu = 0), rest shapes flat, meshes in grain
// coordinates.

#include "tests/support/static_solver.h"

namespace toile::bench {

/// A plate made discrete: three freedoms per carrier (a node, or the middle of an edge), then `extras`
/// further ones.
struct Discretisation {
    std::vector<Vec2> carriers; ///< where they rest
    std::vector<double> areas;  ///< m2 of cloth that each stands for
    int extras = 0;
    test::Term stretch, bend;

    int freedoms() const { return int(3 * carriers.size()) + extras; }
};

struct Candidate {
    std::string name;
    std::function<Discretisation(const Garment&, const Fabric&)> make;
};

/// The element that was chosen, with arcs and with chords in the membrane, and its rivals.
std::vector<Candidate> candidates();

/// The cost of factoring stretch and bend together.
struct FactorCost {
    int unknowns = 0;
    double entries = 0; ///< of the factor
    double seconds = 0; ///< numeric factorisation, best of three
};
FactorCost factor_cost(const Discretisation& plate);

} // namespace toile::bench
