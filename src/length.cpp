// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/length.h"

#include "src/exit_code.h"

#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <cstdio>

namespace toile {

double parse_length(const std::string& text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string unit(end, text.data() + text.size());
    if (error != std::errc() || !std::isfinite(value))
        throw CommandLineError("'" + text + "' is not a length such as 10mm, 1cm or 0.01m");
    if (unit == "mm") return value / 1000;
    if (unit == "cm") return value / 100;
    if (unit == "m") return value;
    if (unit.empty())
        throw CommandLineError("'" + text + "' has no unit: write " + text + "mm, " + text + "cm or " + text +
                               "m");
    throw CommandLineError("'" + text + "' has the unit '" + unit + "', expected mm, cm or m");
}

std::string show_length(double metres) {
    char text[32];
    const bool large = std::abs(metres) >= 1;
    std::snprintf(text, sizeof text, "%.4g %s", large ? metres : 1000 * metres, large ? "m" : "mm");
    return text;
}

void add_length(CLI::App& command, const std::string& name, double& metres, double low, double high,
                const std::string& help) {
    const auto set = [&metres, name, low, high](const std::string& text) {
        try {
            const double value = parse_length(text);
            if (value < low || value > high)
                throw CommandLineError(text + " is outside " + show_length(low) + " to " + show_length(high));
            metres = value;
        } catch (const CommandLineError& error) {
            throw CLI::ValidationError("--" + name, error.what());
        }
    };
    command
        .add_option_function<std::string>("--" + name, set, help + " (default " + show_length(metres) + ")")
        ->type_name("LENGTH");
}

} // namespace toile
