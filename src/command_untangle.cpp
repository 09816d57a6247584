// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include "geometry/parallel.h"
#include "geometry/text.h"
#include "src/options.h"
#include "src/progress.h"
#include "src/quantity.h"
#include "src/untangle_job.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <memory>
#include <ostream>

namespace toile {
namespace {

struct UntangleArguments {
    UntangleJob job;
    int threads = 0;
    bool quiet = false, json = false;
};

void refuse_useless(const UntangleArguments& a) {
    if (a.job.garments.empty() && a.job.report.empty() && !a.json)
        throw CommandLineError("there is nothing to write: name a file with -o or --report");
    if (a.job.repair_avatar && a.job.avatar.empty())
        throw CommandLineError("--repair-avatar needs --avatar");
    refuse_formats(a.job.garments);
}

void print_faults(std::ostream& out, const char* when, const nlohmann::json& i) {
    out << when << ": " << i["intersections"]["cloth_avatar"] << " pairs with the body, "
        << i["intersections"]["cloth_cloth"] << " of the cloth with itself";
    if (i.contains("inside") && !i["inside"].is_null()) out << ", " << i["inside"]["nodes"] << " nodes in the body";
    out << '\n';
}

void summarise(std::ostream& out, const UntangleOutcome& outcome) {
    const auto r = nlohmann::json::parse(outcome.report);
    const auto& c = r["change"];
    print_faults(out, "before", r["before"]);
    print_faults(out, "after", r["after"]);
    out << "moved: " << c["moved_nodes"] << " of " << c["nodes"] << " nodes, by up to "
        << show_length(c["displacement"]["max"])
        << text("; edges changed by up to %.1f %%, %.2f %% in the mean\n", 100 * c["edge_length"]["max"].get<double>(),
                100 * c["edge_length"]["mean"].get<double>());
    list_written(out, outcome.written);
}

int untangle_command(const UntangleArguments& arguments, const Console& console) {
    refuse_useless(arguments);
    set_threads(arguments.threads);
    UntangleJob job = arguments.job;
    const Interrupt interrupt;
    ProgressLine line(console.err, console.terminal && !arguments.quiet);
    job.untangle.progress = [&](const DrapeProgress& progress) {
        line.show(progress);
        return !interrupt.asked();
    };
    job.interrupted = [&] { return interrupt.asked(); };
    const UntangleOutcome outcome = run_untangle(job);
    line.clear();
    if (arguments.json) console.out << outcome.report << std::flush;
    if (!arguments.json && !arguments.quiet) {
        const auto report = nlohmann::json::parse(outcome.report);
        for (const auto& note : report["notes"])
            console.err << "note: " << note.get<std::string>() << '\n';
        summarise(console.out, outcome);
        console.out << std::flush;
    }
    if (outcome.result.status == UntangleStatus::clear) return exit_made;
    console.err << "toile: " << to_string(outcome.result.status) << ": " << outcome.where
                << "; the best state was written" << std::endl;
    return exit_not_converged;
}

} // namespace

void add_untangle(CLI::App& app, Command& chosen) {
    CLI::App& command =
        *app.add_subcommand("untangle", "Move a garment mesh out of itself and out of the body, by as little as will do");
    const auto a = std::make_shared<UntangleArguments>();
    UntangleJob& job = a->job;
    command.add_option("garment", job.garment, "Garment file, .obj or .glb, ours or another tool's")->required()->type_name("FILE");
    command.add_option("--avatar", job.avatar, "Body it lies on (default: the one in the file, if any)")->type_name("FILE");
    command.add_flag("--repair-avatar", job.repair_avatar, "Close the holes of a leaky body");
    command.add_option("-o,--output", job.garments, "Garment file to write, .obj or .glb; may be repeated")
        ->expected(1)
        ->take_all()
        ->type_name("FILE");
    command.add_option("--report", job.report, "Report to write, JSON as in docs/untangle.md")->type_name("FILE");
    add_length(command, "clearance", job.untangle.clearance, 5e-5, 0.01,
               "Distance below which contact acts; what is nearer than a tenth of it is moved apart as well");
    add_duration(command, "max-seconds", job.untangle.max_seconds, 0.001, 1e9,
                 "Time after which the best state reached is written");
    add_run_options(command, a->threads, a->quiet, a->json);
    command.callback(
        [a, &chosen] { chosen = [a](const Console& console) { return untangle_command(*a, console); }; });
}

} // namespace toile
