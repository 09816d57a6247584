// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include "io/input_error.h"
#include "src/version.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <new>
#include <ostream>

namespace toile {
namespace {

/// CLI11 may say more than one line.
std::string first_line(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

int complain(const Console& console, const std::string& sentence, ExitCode code) {
    console.err << "toile: " << first_line(sentence) << std::endl;
    return code;
}

/// Nothing when the first word is a command or an option.
std::string unknown_command(const CLI::App& app, const std::vector<std::string>& arguments) {
    std::string names;
    for (const CLI::App* command : app.get_subcommands({})) {
        if (!arguments.empty() && arguments[0] == command->get_name()) return "";
        names += (names.empty() ? "" : ", ") + command->get_name();
    }
    if (arguments.empty()) return "name a command: " + names;
    if (arguments[0].starts_with('-')) return "";
    return "there is no command '" + arguments[0] + "', the commands are " + names;
}

/// One place turns errors into exit codes.
int guarded(const Command& command, const Console& console) {
    try {
        return command(console);
    } catch (const CommandLineError& error) {
        return complain(console, error.what(), exit_command_line);
    } catch (const std::bad_alloc&) {
        return complain(console, "there is not enough memory for this input", exit_refused);
    } catch (const std::exception& error) {
        return complain(console, error.what(), exit_refused);
    }
}

} // namespace

void list_written(std::ostream& out, const std::vector<std::string>& written) {
    for (std::size_t k = 0; k < written.size(); ++k)
        out << (k == 0 ? "written: " : ", ") << written[k] << (k + 1 == written.size() ? "\n" : "");
}

int run_command_line(const std::vector<std::string>& arguments, const Console& console) {
    CLI::App app("Drapes sewing patterns on bodies and proves the result.", "toile");
    app.set_version_flag("--version", version_text(), "Versions of toile, its libraries and the BLAS in use");
    app.require_subcommand(1);
    app.footer("Exit codes: 0 made; 1 command line; 2 input refused; 3 not converged, slid off, too small or\n"
               "still tangled (the best state is still written). 'toile COMMAND --help' explains a command.");
    Command chosen;
    for (const auto add : {add_drape, add_check, add_flat, add_form, add_inspect, add_untangle, add_compare, add_rest, add_cut,
                           add_fit, add_chart, add_stability})
        add(app, chosen);
    if (const std::string sentence = unknown_command(app, arguments); !sentence.empty())
        return complain(console, sentence, exit_command_line);
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    try {
        app.parse(reversed);
    } catch (const CLI::CallForVersion& version) {
        console.out << version.what() << std::endl;
        return exit_made;
    } catch (const CLI::Success& help) {
        app.exit(help, console.out, console.err);
        return exit_made;
    } catch (const CLI::ParseError& error) {
        return complain(console, error.what(), exit_command_line);
    }
    return guarded(chosen, console);
}

} // namespace toile
