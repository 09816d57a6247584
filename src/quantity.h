// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Numbers with units on the command line.

#include <string>

namespace CLI {
class App;
}

namespace toile {

/// "10mm", "1cm", "0.01m" in metres. Throws CommandLineError when the unit is missing or it is not a length.
double parse_length(const std::string& text);

/// "90s", "5min", "1h", "2ms", "50us" in seconds. Throws CommandLineError when the unit is missing or it is no duration.
double parse_duration(const std::string& text);

/// "0.2%" as 0.002. Throws CommandLineError when the sign is missing or it is no number.
double parse_share(const std::string& text);

/// "500MB", "500MiB", "2GB", "2GiB" in bytes. Throws CommandLineError when the unit is missing or it is no size.
double parse_size(const std::string& text);

/// An option that takes a length of [low, high] metres. The help names what it is by default.
void add_length(CLI::App& command, const std::string& name, double& metres, double low, double high,
                const std::string& help);

/// An option that takes a duration of [low, high] seconds. The help says what it is by default.
void add_duration(CLI::App& command, const std::string& name, double& seconds, double low, double high,
                  const std::string& help);

/// An option that takes a size of [low, high] bytes, and is without limit by default.
void add_size(CLI::App& command, const std::string& name, double& bytes, double low, double high,
              const std::string& help);

/// 5e8 as "500 MB".
std::string show_size(double bytes);

/// 0.0123 as "12.3 mm", or "1.68 m" from one metre on.
std::string show_length(double metres);

} // namespace toile
