// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/chart/chart.h"

#include <string>

namespace toile {

/// Where the times were taken.
struct ChartMachine {
    std::string processor;
    int threads = 0;     ///< of the wall times
    std::string version; ///< of toile
    std::string blas;
};

/// scene,method,edge_length,step,error,error_solver,seconds_cpu,seconds_wall,status: metres, seconds, shares; a step of 0 is the method's own;
/// a solver's error that is not known is empty; status is "converged" or why not.
std::string chart_csv(const Chart& chart);

/// All that the chart holds, by docs/chart.md.
std::string chart_json(const Chart& chart, const ChartMachine& machine);

} // namespace toile
