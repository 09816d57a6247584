// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Commands that run methods on scenes and write a page about it.

#include "draping/method.h"
#include "src/command_line.h"

#include <string>
#include <vector>

namespace toile {

struct PageArguments {
    std::string page;
    std::vector<std::string> methods;
    int threads = 0;
    bool quiet = false, json = false, quick = false;
};

/// -o, --method, --quick (with this help), --threads, --quiet and --json.
void add_page_options(CLI::App& command, PageArguments& arguments, const std::string& quick_help);

/// The methods asked for, each once; none: all.
std::vector<Method> methods_asked(const PageArguments& arguments);

struct PageRun {
    std::string summary, json;
    std::vector<std::string> written; ///< files
};

/// Runs, showing progress, and says what came of it.
int run_page(const PageArguments& arguments, const Console& console,
             const std::function<PageRun(const std::function<void(const std::string& what)>& progress)>& run);

} // namespace toile
