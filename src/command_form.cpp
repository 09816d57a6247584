// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include "sewing/avatar.h"
#include "src/quantity.h"
#include "src/options.h"
#include "src/pipeline.h"

#include <CLI/CLI.hpp>

#include <memory>
#include <ostream>

namespace toile {
namespace {

struct FormArguments {
    FormMeasures measures;
    WriteOptions write;
    std::string output;
    bool quiet = false;
};

int form_command(const FormArguments& a, const Console& console) {
    const TriMesh form = form_of(a.measures);
    write_mesh(a.output, form, a.write);
    if (a.quiet) return exit_made;
    const BodyMeasures m = measure_body(form);
    console.out << "height " << show_length(m.height) << ", bust " << show_length(m.bust) << " at "
                << show_length(m.bust_y) << ", waist " << show_length(m.waist) << " at "
                << show_length(m.waist_y) << ", hip " << show_length(m.hip) << " at " << show_length(m.hip_y)
                << "\nwritten: " << a.output << std::endl;
    return exit_made;
}

} // namespace

void add_form(CLI::App& app, Command& chosen) {
    CLI::App& command = *app.add_subcommand("form", "Write the built-in dress form as a mesh");
    const auto a = std::make_shared<FormArguments>();
    add_form_measures(command, a->measures);
    command.add_option("-o,--output", a->output, "OBJ file to write")
        ->required()
        ->type_name("FILE")
        ->check([](const std::string& path) {
            return path.ends_with(".obj") ? std::string() : path + " does not end in .obj";
        });
    add_unit_and_up(command, a->write);
    command.add_flag("--quiet", a->quiet, "Print errors only");
    command.callback(
        [a, &chosen] { chosen = [a](const Console& console) { return form_command(*a, console); }; });
}

} // namespace toile
