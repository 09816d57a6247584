// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace toile {

/// "10mm", "1cm", "0.01m" in metres. Throws CommandLineError when the unit is missing or it is not a length.
double parse_length(const std::string& text);

/// An option that takes a length of [low, high] metres.
void add_length(CLI::App& command, const std::string& name, double& metres, double low, double high,
                const std::string& help);

/// 0.0123 as "12.3 mm", or "1.68 m" from one metre on.
std::string show_length(double metres);

} // namespace toile
