// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Run scenes by methods and write error against time.

#include "draping/chart/chart.h"

#include <string>
#include <vector>

namespace toile {

struct ChartJob {
    std::vector<std::string> scenes; ///< names, or what they begin with; empty: all
    std::string pattern;             ///< file of a garment that is a scene too; empty: none
    ChartOptions options;            ///< but for the scenes; no methods: all
    std::string page;                ///< HTML file; beside it go name.csv, name.json and name-SCENE.svg
};

struct ChartOutcome {
    Chart chart;
    std::string json; ///< as written
    std::vector<std::string> written;
};

/// Does the job. Throws InputError when there is no such scene or a target cannot be written, before anything is run.
ChartOutcome run_chart(const ChartJob& job);

} // namespace toile
