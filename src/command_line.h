// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "src/exit_code.h"

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace toile {

/// Where a command speaks to.
struct Console {
    std::ostream& out;
    std::ostream& err;
    bool terminal = false; ///< err is a terminal: progress may be shown and overwritten
};

/// Arguments without the program's name. Returns an ExitCode; every failure is one sentence on console.err.
int run_command_line(const std::vector<std::string>& arguments, const Console& console);

/// The files that a command has written, on one line; nothing when there are none.
void list_written(std::ostream& out, const std::vector<std::string>& written);

/// What the command line asks for, once it is parsed.
using Command = std::function<int(const Console&)>;

// Each adds its command to the parser and, when that is the one given, sets `chosen`.
void add_drape(CLI::App& app, Command& chosen);
void add_check(CLI::App& app, Command& chosen);
void add_flat(CLI::App& app, Command& chosen);
void add_form(CLI::App& app, Command& chosen);
void add_inspect(CLI::App& app, Command& chosen);
void add_untangle(CLI::App& app, Command& chosen);
void add_compare(CLI::App& app, Command& chosen);
void add_rest(CLI::App& app, Command& chosen);
void add_cut(CLI::App& app, Command& chosen);
void add_fit(CLI::App& app, Command& chosen);
void add_chart(CLI::App& app, Command& chosen);
void add_stability(CLI::App& app, Command& chosen);

} // namespace toile
