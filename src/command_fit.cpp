// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include "geometry/parallel.h"
#include "geometry/text.h"
#include "src/fit_job.h"
#include "src/options.h"
#include "src/progress.h"
#include "src/quantity.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <memory>
#include <ostream>

namespace toile {
namespace {

struct FitArguments {
    FitJob job;
    int threads = 0;
    bool quiet = false, json = false;
};

void refuse_useless(const FitArguments& a) {
    const FitJob& job = a.job;
    if (job.output.empty() && job.garments.empty() && job.picture.empty() && job.report.empty() && !a.json)
        throw CommandLineError("there is nothing to write: name a file with -o, --garment, --picture or --report");
    if (job.repair_avatar && job.avatar.empty()) throw CommandLineError("--repair-avatar needs --avatar; the built-in form is closed");
    refuse_formats(job.garments);
}

void summarise(std::ostream& out, const FitOutcome& outcome) {
    const auto r = nlohmann::json::parse(outcome.report);
    out << r["status"].get<std::string>() << text(" after %d equilibria\n", r["evaluations"].get<int>());
    for (const auto& g : r["goals"])
        out << text("goal %s: %.4g, was %.4g, allowed %.4g\n", g["name"].get<std::string>().c_str(), g["after"].get<double>(),
                    g["before"].get<double>(), g["tolerance"].get<double>());
    for (const auto& a : r["alterations"])
        out << (a.contains("mm") ? text("%+8.2f mm  ", a["mm"].get<double>()) : text("%+8.2f %%   ", a["percent"].get<double>()))
            << a["name"].get<std::string>() << (a["at_bound"].get<bool>() ? " (at its bound)" : "") << '\n';
    for (const auto& e : r["elastics"])
        out << text("elastic on edge %d of panel %s: %.1f mm relaxed, was %.1f\n", e["edge"].get<int>(), e["panel"].get<std::string>().c_str(),
                    e["relaxed_after_mm"].get<double>(), e["relaxed_before_mm"].get<double>());
    for (const auto& s : r["shrunk"])
        out << text("panel %s, after it is cut: shrunk by %.2f %% along the warp, was %.2f, and %.2f %% along the weft, was %.2f\n",
                    s["panel"].get<std::string>().c_str(), s["warp_after_percent"].get<double>(), s["warp_before_percent"].get<double>(),
                    s["weft_after_percent"].get<double>(), s["weft_before_percent"].get<double>());
    for (const auto& s : r["seams"]["eased"])
        out << text("eased: %s, %.1f to %.1f mm at rest\n", s["seam"].get<std::string>().c_str(), s["a_mm"].get<double>(),
                    s["b_mm"].get<double>());
    out << text("%d seams kept, their sides differ by %.4f mm at most beyond their ease\n", r["seams"]["kept"].get<int>(),
                r["seams"]["unequal_mm"].get<double>());
    list_written(out, outcome.written);
}

int fit_command(const FitArguments& arguments, const Console& console) {
    refuse_useless(arguments);
    set_threads(arguments.threads);
    FitJob job = arguments.job;
    const Interrupt interrupt;
    ProgressLine line(console.err, console.terminal && !arguments.quiet);
    job.drape.progress = [&](const DrapeProgress& p) {
        line.show(p);
        return !interrupt.asked();
    };
    job.progress = [&](int equilibria, double value) {
        DrapeProgress p;
        p.stage = text("fit, equilibrium %d, value %.4g", equilibria, value);
        line.show(p);
        return !interrupt.asked();
    };
    const FitOutcome outcome = run_fit(job);
    line.clear();
    if (arguments.json)
        console.out << outcome.report << std::flush;
    else if (!arguments.quiet)
        summarise(console.out, outcome);
    console.out << std::flush;
    if (outcome.result.end == FitEnd::met) return exit_made;
    console.err << "toile: " << to_string(outcome.result.end) << ": " << outcome.result.why << std::endl;
    return exit_not_converged;
}

} // namespace

void add_fit(CLI::App& app, Command& chosen) {
    CLI::App& command = *app.add_subcommand("fit", "Alter a pattern until its drape meets goals: a shape, a level hem, ease, stretch");
    const auto a = std::make_shared<FitArguments>();
    FitJob& job = a->job;
    const auto file = [&command](const char* name, std::string& path, const char* help) {
        return command.add_option(name, path, help)->type_name("FILE");
    };
    file("pattern", job.pattern, "Pattern")->required();
    file("--spec", job.spec, "What may be altered and what is to be reached, JSON as in docs/fit.md")->required();
    file("--avatar", job.avatar, "Body (default: a built-in form)");
    command.add_flag("--repair-avatar", job.repair_avatar, "Close the holes of a leaky body");
    add_form_measures(command, job.form);
    add_fabric(command, job.fabric, "Fabric of panels that name none (default: the pattern's, else poplin)");
    add_length(command, "edge-length", job.edge_length, 1e-3, 0.5, "Mean edge of the mesh (default 20mm)");
    add_duration(command, "max-seconds", job.max_seconds, 0, 1e9, "Time for the search (default: no limit)");
    file("-o,--output", job.output, "Pattern to write, in the form of the one that was read");
    command.add_option("--garment", job.garments, "Garment file of the altered drape to write, .obj or .glb; may be repeated")
        ->type_name("FILE");
    file("--picture", job.picture, "Picture to write, SVG: old and new outlines at full size");
    file("--report", job.report, "Report to write, JSON as in docs/fit.md");
    add_run_options(command, a->threads, a->quiet, a->json);
    command.callback([a, &chosen] { chosen = [a](const Console& console) { return fit_command(*a, console); }; });
}

} // namespace toile
