// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Where methods work and where they fail, over stiffness, step and mesh, beside where theory says so.

#include "draping/stability/scene.h"

#include <functional>

namespace toile {

struct StabilityOptions {
    std::vector<StabilityMesh> meshes;
    int columns = 11, rows = 13; ///< stiffnesses and values of a map
    std::function<void(const std::string& what)> progress; ///< called before every map
};

struct StabilityRun {
    StabilityMesh mesh;
    double stiffness = 0; ///< of stretch times length^2 over that of the plate
    double value = 0;     ///< in the scene's unit
    double boundary = 0;  ///< of this mesh and stiffness
    StabilityOutcome outcome;
};

struct StabilityMap {
    StabilityScene scene;
    std::vector<double> stiffness, values; ///< rising
    std::vector<StabilityRun> runs;        ///< by stiffness, mesh, value
};

inline constexpr double least_stiffness = 1e2, most_stiffness = 1e7;

/// Every kind as it is and with so many jitters.
std::vector<StabilityMesh> stability_meshes(int seeds);
const char* to_string(MeshKind kind); ///< "aligned", "alternating", "unstructured"

/// So many values from low to high at equal ratios; of counts, rounded, each once.
std::vector<double> spread_values(double low, double high, int count, bool whole);

StabilityMap make_map(const StabilityScene& scene, const StabilityOptions& options);

/// What theory says of a run.
bool should_fail(const StabilityScene& scene, const StabilityRun& run);

/// How runs compare with theory, those within a factor of `band` of the boundary left out.
struct StabilityCount {
    int as_theory = 0, earlier = 0, later = 0, left_out = 0; ///< failed earlier or later than theory says
    int failed = 0;                                          ///< of all
};
StabilityCount compare_with_theory(const StabilityMap& map, double band);

} // namespace toile
