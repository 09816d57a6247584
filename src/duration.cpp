// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/duration.h"

#include "src/exit_code.h"

#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>

namespace toile {

double parse_duration(const std::string& text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string unit(end, text.data() + text.size());
    if (error != std::errc() || !std::isfinite(value))
        throw CommandLineError("'" + text + "' is not a duration such as 90s, 5min or 1h");
    if (unit == "s") return value;
    if (unit == "min") return 60 * value;
    if (unit == "h") return 3600 * value;
    if (unit.empty())
        throw CommandLineError("'" + text + "' has no unit: write " + text + "s, " + text + "min or " + text +
                               "h");
    throw CommandLineError("'" + text + "' has the unit '" + unit + "', expected s, min or h");
}

void add_duration(CLI::App& command, const std::string& name, double& seconds, double low, double high,
                  const std::string& help) {
    const auto set = [&seconds, name, low, high](const std::string& text) {
        try {
            const double value = parse_duration(text);
            if (value < low || value > high) throw CommandLineError(text + " is out of range");
            seconds = value;
        } catch (const CommandLineError& error) {
            throw CLI::ValidationError("--" + name, error.what());
        }
    };
    command.add_option_function<std::string>("--" + name, set, help)->type_name("DURATION");
}

} // namespace toile
