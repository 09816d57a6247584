// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include "io/flat_svg.h"
#include "io/json.h"
#include "io/read_pattern.h"
#include "src/drape_input.h"

#include <CLI/CLI.hpp>

#include <memory>
#include <ostream>

namespace toile {
namespace {

struct FlatArguments {
    std::string pattern, output;
};

} // namespace

void add_flat(CLI::App& app, Command& chosen) {
    CLI::App& command =
        *app.add_subcommand("flat", "Draw the pattern: panels, grain, seams numbered in pairs");
    const auto a = std::make_shared<FlatArguments>();
    command.add_option("pattern", a->pattern, "Pattern file")->required()->type_name("FILE");
    command.add_option("-o,--output", a->output, "SVG file to write")
        ->required()
        ->type_name("FILE")
        ->check([](const std::string& path) {
            return path.ends_with(".svg") ? std::string() : path + " does not end in .svg";
        });
    command.callback([a, &chosen] {
        chosen = [a](const Console&) -> int {
            if (is_staged(a->pattern))
                throw InputError(a->pattern + " is a staged mesh; a pattern of panels with edges was expected, a mesh "
                                              "shows its own flat pattern in any viewer of texture coordinates");
            const Pattern pattern = read_pattern(a->pattern);
            if (const Panel* panel = moulded_panel(pattern))
                throw InputError(a->pattern + ": panel " + in_quotes(panel->name) + " has a rest mesh and no outline that could be drawn");
            write_flat_svg(a->output, pattern);
            return exit_made;
        };
    });
}

} // namespace toile
