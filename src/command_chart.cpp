// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/text.h"
#include "src/chart_job.h"
#include "src/page_command.h"
#include "src/quantity.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>

namespace toile {
namespace {

constexpr int quick_meshes = 3;
constexpr double quick_seconds = 0.3;

struct ChartArguments {
    PageArguments page;
    std::vector<std::string> scenes;
    std::string pattern;
    double max_seconds = 0; ///< 0: by default
};

/// The fastest at rest within an error, of every scene.
std::string summary(const Chart& chart) {
    std::string words;
    for (const ChartScene& s : chart.scenes) {
        words += s.scene.name + ":";
        for (const double share : marked_errors) {
            const ChartPoint* best = fastest_within(chart, s.scene.name, share);
            words += text(" within %g %%: ", 100 * share) +
                     (best ? text("%s, edges of %.3g mm, %.3g s", to_string(best->method), 1e3 * best->edge_length, best->seconds_cpu) : "none") +
                     (share == marked_errors.back() ? "\n" : ";");
        }
    }
    const auto failed = std::count_if(chart.points.begin(), chart.points.end(), [](const ChartPoint& p) { return !p.failure.empty(); });
    return words + text("%zu points, %d of them not at rest\n", chart.points.size(), int(failed));
}

int chart_command(const ChartArguments& a, const Console& console) {
    ChartJob job{a.scenes, a.pattern, {}, a.page.page};
    ChartOptions& options = job.options;
    options.methods = methods_asked(a.page);
    if (a.page.quick) {
        options.meshes = quick_meshes;
        options.steps = options.repeats = 1;
        options.max_seconds = quick_seconds;
    }
    if (a.max_seconds > 0) options.max_seconds = a.max_seconds;
    return run_page(a.page, console, [&](const auto& progress) {
        options.progress = progress;
        ChartOutcome outcome = run_chart(job);
        return PageRun{summary(outcome.chart), std::move(outcome.json), std::move(outcome.written)};
    });
}

} // namespace

void add_chart(CLI::App& app, Command& chosen) {
    CLI::App& command = *app.add_subcommand("chart", "Chart error against time, by scenes with known answers, methods and mesh sizes");
    const auto a = std::make_shared<ChartArguments>();
    add_page_options(command, a->page, "Three meshes instead of four, one step size instead of three, one run of each instead of five, given up after 0.3 s");
    command.add_option("--scene", a->scenes, "Scene, or what the names of several begin with; may be repeated (default: all)")->type_name("NAME");
    command.add_option("--pattern", a->pattern, "Pattern of a garment that is a scene too, on the built-in form, under the name of the file")->type_name("FILE");
    add_duration(command, "max-seconds", a->max_seconds, 0.001, 1e6, "Processor time after which a run has failed (default 20 s; with --quick 0.3 s)");
    command.callback([a, &chosen] { chosen = [a](const Console& console) { return chart_command(*a, console); }; });
}

} // namespace toile
