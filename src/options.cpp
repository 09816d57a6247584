// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/options.h"

#include "draping/method.h"
#include "io/read_fabric.h"
#include "src/exit_code.h"
#include "src/quantity.h"

#include <CLI/CLI.hpp>

#include <map>

namespace toile {

void add_form_measures(CLI::App& command, FormMeasures& form) {
    const FormMeasures standard;
    form = standard;
    add_length(command, "height", form.height, 1.2, 2.1, "Height of the built-in form");
    add_length(command, "bust", form.bust, 0.6, 1.5, "Its bust girth");
    add_length(command, "waist", form.waist, 0.5, 1.5, "Its waist girth");
    add_length(command, "hip", form.hip, 0.6, 1.6, "Its hip girth");
}

void add_unit_and_up(CLI::App& command, WriteOptions& write) {
    static const std::map<std::string, double> units{{"m", 1}, {"cm", 0.01}, {"mm", 0.001}};
    command
        .add_option_function<std::string>(
            "--unit", [&write](const std::string& unit) { write.metres_per_unit = units.at(unit); },
            "Unit of written OBJ files (default m; GLB is metres by its standard)")
        ->check(CLI::IsMember({"m", "cm", "mm"}).description(""))
        ->type_name("m|cm|mm");
    command
        .add_option_function<std::string>(
            "--up", [&write](const std::string& up) { write.z_up = up == "z"; },
            "Up axis of written OBJ files (default y; GLB is y up by its standard)")
        ->check(CLI::IsMember({"y", "z"}).description(""))
        ->type_name("y|z");
}

void add_run_options(CLI::App& command, int& threads, bool& quiet, bool& json) {
    command.add_option("--threads", threads, "Threads to use (default 0: all); the result does not depend on it")
        ->check(CLI::Range(0, 1024).description(""))
        ->type_name("COUNT");
    command.add_flag("--quiet", quiet, "Print errors only");
    command.add_flag("--json", json, "Print the report instead of a summary");
}

void refuse_formats(const std::vector<std::string>& garments) {
    for (const std::string& path : garments) {
        try {
            garment_format(path);
        } catch (const std::exception& error) {
            throw CommandLineError(error.what());
        }
    }
}

void add_fabric(CLI::App& command, std::string& fabric, const std::string& help) {
    std::string names;
    for (const Fabric& preset : fabric_presets())
        names += (names.empty() ? "" : " ") + preset.name;
    command.add_option("--fabric", fabric, help + ": " + names + ", or a file by docs/fabric.schema.json (.json)")
        ->check([](const std::string& name) {
            try {
                if (!is_fabric_file(name)) fabric_preset(name);
                return std::string();
            } catch (const std::invalid_argument& error) {
                return std::string(error.what());
            }
        })
        ->type_name("NAME");
}

} // namespace toile
