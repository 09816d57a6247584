// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/chart/chart.h"

#include <string>

namespace toile {

/// One scene as a picture: error over processor time, both logarithmic, a curve through the meshes of every method and step, the Pareto front as a wide
/// grey line, crosses for what did not come to rest, lines at errors of 5 and 1 %. A scene with a band
/// has what it measures, linear, over time, and the band. What a mark stands for is said where the pointer rests on it.
std::string chart_svg(const Chart& chart, const ChartScene& scene);

} // namespace toile
