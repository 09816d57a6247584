// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/text.h"
#include "io/stability_svg.h"
#include "io/stability_table.h"
#include "src/page_command.h"
#include "src/stability_job.h"

#include <CLI/CLI.hpp>

#include <memory>

namespace toile {
namespace {

constexpr int seeds = 5, quick_seeds = 1;
constexpr int quick_columns = 6, quick_rows = 7;

/// Of every map, how often it failed and how that compares with theory.
std::string summary(const std::vector<StabilityMap>& maps) {
    std::string words;
    for (const StabilityMap& map : maps) {
        const StabilityCount c = compare_with_theory(map, theory_band);
        words += map_title(map) + text(": %d of %zu runs failed", c.failed, map.runs.size());
        if (!map.scene.theory.empty())
            words += text("; %d as theory says, %d earlier, %d later, %d near the boundary", c.as_theory, c.earlier, c.later, c.left_out);
        words += '\n';
    }
    return words;
}

int stability_command(const PageArguments& a, const Console& console) {
    StabilityJob job;
    job.page = a.page;
    job.methods = methods_asked(a);
    job.options.meshes = stability_meshes(a.quick ? quick_seeds : seeds);
    if (a.quick) {
        job.options.columns = quick_columns;
        job.options.rows = quick_rows;
    }
    return run_page(a, console, [&](const auto& progress) {
        job.options.progress = progress;
        StabilityJobOutcome outcome = run_stability(job);
        return PageRun{summary(outcome.maps), std::move(outcome.json), std::move(outcome.written)};
    });
}

} // namespace

void add_stability(CLI::App& app, Command& chosen) {
    CLI::App& command = *app.add_subcommand("stability", "Map where methods work and where they fail, over stiffness, step and mesh, beside where theory says so");
    const auto a = std::make_shared<PageArguments>();
    add_page_options(command, *a, "6 stiffnesses by 7 values on meshes of one jitter, instead of 11 by 13 on meshes of five");
    command.callback([a, &chosen] { chosen = [a](const Console& console) { return stability_command(*a, console); }; });
}

} // namespace toile
