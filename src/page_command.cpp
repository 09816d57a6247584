// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/page_command.h"

#include "geometry/parallel.h"
#include "src/options.h"
#include "src/progress.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <ostream>

namespace toile {

void add_page_options(CLI::App& command, PageArguments& arguments, const std::string& quick_help) {
    command.add_option("-o,--output", arguments.page, "Page to write, .html; its data and pictures go beside it as .csv, .json and .svg")
        ->type_name("FILE")
        ->required()
        ->check([](const std::string& path) { return path.ends_with(".html") ? std::string() : path + " does not end in .html"; });
    std::vector<std::string> names;
    for (const Method m : all_methods()) names.push_back(to_string(m));
    command.add_option("--method", arguments.methods, "Method; may be repeated (default: all)")
        ->check(CLI::IsMember(names).description(""))
        ->type_name("NAME");
    command.add_flag("--quick", arguments.quick, quick_help);
    add_run_options(command, arguments.threads, arguments.quiet, arguments.json);
}

std::vector<Method> methods_asked(const PageArguments& arguments) {
    std::vector<Method> methods;
    for (const std::string& name : arguments.methods) {
        const Method method = method_called(name);
        if (std::find(methods.begin(), methods.end(), method) == methods.end()) methods.push_back(method);
    }
    return methods;
}

int run_page(const PageArguments& arguments, const Console& console,
             const std::function<PageRun(const std::function<void(const std::string& what)>& progress)>& run) {
    set_threads(arguments.threads);
    ProgressLine line(console.err, console.terminal && !arguments.quiet);
    const PageRun done = run([&line](const std::string& what) { line.show(what); });
    line.clear();
    if (arguments.json) {
        console.out << done.json;
    } else if (!arguments.quiet) {
        console.out << done.summary;
        list_written(console.out, done.written);
    }
    console.out << std::flush;
    return exit_made;
}

} // namespace toile
