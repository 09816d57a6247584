// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include "geometry/parallel.h"
#include "geometry/text.h"
#include "src/chart_job.h"
#include "src/options.h"
#include "src/progress.h"
#include "src/quantity.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <ostream>

namespace toile {
namespace {

constexpr int quick_meshes = 3;
constexpr double quick_seconds = 0.5;

struct ChartArguments {
    ChartJob job;
    std::vector<std::string> methods;
    double max_seconds = 0; ///< 0: by default
    int threads = 0;
    bool quiet = false, json = false, quick = false;
};

/// The fastest at rest within an error, of every scene.
void summarise(std::ostream& out, const ChartOutcome& outcome) {
    for (const ChartScene& s : outcome.chart.scenes) {
        out << s.scene.name << ":";
        for (const double share : marked_errors) {
            const ChartPoint* best = fastest_within(outcome.chart, s.scene.name, share);
            out << text(" within %g %%: ", 100 * share)
                << (best ? text("%s, edges of %.3g mm, %.3g s", to_string(best->method), 1e3 * best->edge_length, best->seconds_cpu) : "none")
                << (share == marked_errors.back() ? "\n" : ";");
        }
    }
    const auto failed = std::count_if(outcome.chart.points.begin(), outcome.chart.points.end(), [](const ChartPoint& p) { return !p.failure.empty(); });
    out << outcome.chart.points.size() << " points, " << failed << " of them not at rest\n";
    list_written(out, outcome.written);
}

int chart_command(const ChartArguments& a, const Console& console) {
    set_threads(a.threads);
    ChartJob job = a.job;
    ChartOptions& options = job.options;
    for (const std::string& name : a.methods) {
        const Method method = method_called(name);
        if (std::find(options.methods.begin(), options.methods.end(), method) == options.methods.end()) options.methods.push_back(method);
    }
    if (a.quick) {
        options.meshes = quick_meshes;
        options.steps = options.repeats = 1;
        options.max_seconds = quick_seconds;
    }
    if (a.max_seconds > 0) options.max_seconds = a.max_seconds;
    ProgressLine line(console.err, console.terminal && !a.quiet);
    options.progress = [&line](const std::string& what) { line.show(what); };
    const ChartOutcome outcome = run_chart(job);
    line.clear();
    if (a.json)
        console.out << outcome.json << std::flush;
    else if (!a.quiet)
        summarise(console.out, outcome);
    console.out << std::flush;
    return exit_made;
}

} // namespace

void add_chart(CLI::App& app, Command& chosen) {
    CLI::App& command = *app.add_subcommand("chart", "Chart error against time, by scenes with known answers, methods and mesh sizes");
    const auto a = std::make_shared<ChartArguments>();
    add_page(command, a->job.page);
    command.add_option("--scene", a->job.scenes, "Scene, or what the names of several begin with; may be repeated (default: all)")->type_name("NAME");
    command.add_option("--pattern", a->job.pattern, "Pattern of a garment that is a scene too, on the built-in form, under the name of the file")->type_name("FILE");
    add_methods(command, a->methods);
    command.add_flag("--quick", a->quick, "Three meshes instead of four, one step size instead of three, one run of each instead of five, given up after 0.5 s");
    add_duration(command, "max-seconds", a->max_seconds, 0.001, 1e6, "Time after which a run has failed (default 20 s; with --quick 0.5 s)");
    add_run_options(command, a->threads, a->quiet, a->json);
    command.callback([a, &chosen] { chosen = [a](const Console& console) { return chart_command(*a, console); }; });
}

} // namespace toile
