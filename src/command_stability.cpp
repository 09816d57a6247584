// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include "geometry/parallel.h"
#include "geometry/text.h"
#include "io/stability_svg.h"
#include "io/stability_table.h"
#include "src/options.h"
#include "src/progress.h"
#include "src/stability_job.h"

#include <CLI/CLI.hpp>

#include <memory>
#include <ostream>

namespace toile {
namespace {

constexpr int seeds = 5, quick_seeds = 1;
constexpr int quick_columns = 6, quick_rows = 7;

struct StabilityArguments {
    StabilityJob job;
    std::vector<std::string> methods;
    int threads = 0;
    bool quiet = false, json = false, quick = false;
};

/// Of every map, how often it failed and how that compares with theory.
void summarise(std::ostream& out, const StabilityJobOutcome& outcome) {
    for (const StabilityMap& map : outcome.maps) {
        const StabilityCount c = compare_with_theory(map, theory_band);
        out << map_title(map) << text(": %d of %zu runs failed", c.failed, map.runs.size());
        if (!map.scene.theory.empty()) out << text("; %d as theory says, %d earlier, %d later, %d near the boundary", c.as_theory, c.earlier, c.later, c.left_out);
        out << '\n';
    }
    list_written(out, outcome.written);
}

int stability_command(const StabilityArguments& a, const Console& console) {
    set_threads(a.threads);
    StabilityJob job = a.job;
    for (const std::string& name : a.methods) job.methods.push_back(method_called(name));
    job.options.meshes = stability_meshes(a.quick ? quick_seeds : seeds);
    if (a.quick) {
        job.options.columns = quick_columns;
        job.options.rows = quick_rows;
    }
    ProgressLine line(console.err, console.terminal && !a.quiet);
    job.options.progress = [&line](const std::string& what) { line.show(what); };
    const StabilityJobOutcome outcome = run_stability(job);
    line.clear();
    if (a.json)
        console.out << outcome.json << std::flush;
    else if (!a.quiet)
        summarise(console.out, outcome);
    console.out << std::flush;
    return exit_made;
}

} // namespace

void add_stability(CLI::App& app, Command& chosen) {
    CLI::App& command = *app.add_subcommand("stability", "Map where methods work and where they fail, over stiffness, step and mesh, beside where theory says so");
    const auto a = std::make_shared<StabilityArguments>();
    add_page(command, a->job.page);
    add_methods(command, a->methods);
    command.add_flag("--quick", a->quick, "6 stiffnesses by 7 values on meshes of one jitter, instead of 11 by 13 on meshes of five");
    add_run_options(command, a->threads, a->quiet, a->json);
    command.callback([a, &chosen] { chosen = [a](const Console& console) { return stability_command(*a, console); }; });
}

} // namespace toile
