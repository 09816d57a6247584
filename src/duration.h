// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace toile {

/// "90s", "5min", "1h" in seconds. Throws CommandLineError when the unit is missing or it is no duration.
double parse_duration(const std::string& text);

/// An option that takes a duration of [low, high] seconds.
void add_duration(CLI::App& command, const std::string& name, double& seconds, double low, double high,
                  const std::string& help);

} // namespace toile
