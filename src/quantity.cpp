// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/quantity.h"

#include "geometry/text.h"
#include "src/exit_code.h"

#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <vector>

namespace toile {

namespace {

struct Unit {
    const char* name;
    double times, over; ///< of the SI unit; both, since 1 / 1000 is no binary fraction
};

struct Quantity {
    const char* what;
    const char* examples;
    std::vector<Unit> units;
    std::string (*show)(double);
};

std::string show_duration(double seconds) {
    return text("%g s", seconds);
}

const Quantity length_of_something{
    "a length", "10mm, 1cm or 0.01m", {{"mm", 1, 1000}, {"cm", 1, 100}, {"m", 1, 1}}, show_length};
const Quantity duration{
    "a duration", "90s, 5min or 1h", {{"us", 1, 1e6}, {"ms", 1, 1e3}, {"s", 1, 1}, {"min", 60, 1}, {"h", 3600, 1}}, show_duration};
const Quantity size_of_memory{
    "a size",
    "500MB or 2GiB",
    {{"MB", 1e6, 1}, {"MiB", 0x1p20, 1}, {"GB", 1e9, 1}, {"GiB", 0x1p30, 1}},
    show_size};

const Quantity share_of_something{"a share", "0.2%", {{"%", 1, 100}}, [](double share) { return text("%g %%", 100 * share); }};

/// "mm, cm or m", each after `prefix`.
std::string list(const Quantity& q, const std::string& prefix) {
    std::string text;
    for (const Unit& u : q.units)
        text += (text.empty() ? "" : &u == &q.units.back() ? " or " : ", ") + prefix + u.name;
    return text;
}

double parse(const Quantity& q, const std::string& text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string unit(end, text.data() + text.size());
    if (error != std::errc() || !std::isfinite(value))
        throw CommandLineError("'" + text + "' is not " + q.what + " such as " + q.examples);
    for (const Unit& u : q.units)
        if (unit == u.name) return value * u.times / u.over;
    if (unit.empty()) throw CommandLineError("'" + text + "' has no unit: write " + list(q, text));
    throw CommandLineError("'" + text + "' has the unit '" + unit + "', expected " + list(q, ""));
}

CLI::Option* add(const Quantity& q, CLI::App& command, const std::string& name, double& target, double low,
                 double high, const std::string& help) {
    const auto set = [&q, &target, name, low, high](const std::string& text) {
        try {
            const double value = parse(q, text);
            if (value < low || value > high)
                throw CommandLineError(text + " is outside " + q.show(low) + " to " + q.show(high));
            target = value;
        } catch (const CommandLineError& error) {
            throw CLI::ValidationError("--" + name, error.what());
        }
    };
    return command.add_option_function<std::string>("--" + name, set, help);
}

} // namespace

double parse_length(const std::string& text) { return parse(length_of_something, text); }

double parse_duration(const std::string& text) { return parse(duration, text); }

double parse_share(const std::string& text) { return parse(share_of_something, text); }

double parse_size(const std::string& text) { return parse(size_of_memory, text); }

std::string show_length(double metres) {
    const bool large = std::abs(metres) >= 1;
    return text("%.4g %s", large ? metres : 1000 * metres, large ? "m" : "mm");
}

std::string show_size(double bytes) {
    return text("%.4g MB", bytes / 1e6);
}

void add_length(CLI::App& command, const std::string& name, double& metres, double low, double high,
                const std::string& help) {
    add(length_of_something, command, name, metres, low, high, help + " (default " + show_length(metres) + ")")
        ->type_name("LENGTH");
}

void add_duration(CLI::App& command, const std::string& name, double& seconds, double low, double high,
                  const std::string& help) {
    add(duration, command, name, seconds, low, high, help)->type_name("DURATION");
}

void add_size(CLI::App& command, const std::string& name, double& bytes, double low, double high,
              const std::string& help) {
    add(size_of_memory, command, name, bytes, low, high, help)->type_name("SIZE");
}

} // namespace toile
