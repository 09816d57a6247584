// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Small strips of cloth on which methods are driven to where they fail: how soft or stiff the cloth may be for what step, or whatever
// else a method can have too much or too little of. docs/stability.md says what each does.

#include "draping/method.h"
#include "sewing/sheet_mesh.h"

#include <functional>
#include <string>
#include <vector>

namespace toile {

/// The mesh of a strip: as it is for seed 0, and jittered for others.
struct StabilityMesh {
    MeshKind kind = MeshKind::aligned;
    int seed = 0;
};

struct StabilityOutcome {
    double measure = 0;  ///< what decides, in the words of StabilityScene::measure
    std::string failure; ///< a few words; empty: it worked
};

/// One mesh of one stiffness.
struct StabilityColumn {
    double boundary = 0; ///< value at which theory has the method begin or cease to fail; infinity: at none
    std::vector<StabilityOutcome> outcomes; ///< by value
};

struct StabilityScene {
    Method method = Method::equilibrium;
    std::string name;    ///< "swing"; unique with the method
    std::string what;    ///< a sentence: what the strip does and what counts as failing
    std::string axis;    ///< "step"
    std::string unit;    ///< "s"; empty: a number
    std::string measure; ///< "amplitude left after a period"
    std::string theory;  ///< "2 / w"
    double low = 0, high = 0; ///< range of the values
    bool whole = false;       ///< values are counts
    bool stiffness_matters = true; ///< otherwise a map has the same runs at all
    bool fails_above = true;  ///< the boundary, otherwise below
    /// `stiffness` is that of stretch times length^2 over that of the plate; values rise.
    std::function<StabilityColumn(const StabilityMesh& mesh, double stiffness, const std::vector<double>& values)> run;
};

/// All of them, at least one of every method.
std::vector<StabilityScene> stability_scenes();

} // namespace toile
