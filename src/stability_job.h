// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Run methods to where they fail and write the maps.

#include "draping/stability/map.h"

#include <string>
#include <vector>

namespace toile {

struct StabilityJob {
    std::vector<Method> methods; ///< empty: all
    StabilityOptions options;
    std::string page;            ///< HTML file; beside it go name.csv, name.json and name-METHOD-SCENE.svg
};

struct StabilityJobOutcome {
    std::vector<StabilityMap> maps;
    std::string json; ///< as written
    std::vector<std::string> written;
};

/// Does the job. Throws InputError when a target cannot be written, before anything is run.
StabilityJobOutcome run_stability(const StabilityJob& job);

} // namespace toile
