// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "io/chart_table.h"

namespace toile {

/// The chart as one page of HTML that needs nothing else: the pictures of all scenes, which method is nearest at 5 and 1 % of error, and every point
/// as a table.
std::string chart_page(const Chart& chart, const ChartMachine& machine);

} // namespace toile
