// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include "geometry/parallel.h"
#include "geometry/text.h"
#include "src/cut_job.h"
#include "src/options.h"
#include "src/quantity.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <memory>
#include <ostream>

namespace toile {
namespace {

struct CutArguments {
    CutJob job;
    int threads = 0;
    bool quiet = false, json = false;
};

void summarise(std::ostream& out, const CutOutcome& outcome) {
    const auto r = nlohmann::json::parse(outcome.report);
    for (const auto& p : r["panels"]) {
        out << text("panel %s: strained by %.2f %% on the mean, at most %.2f %%", p["name"].get<std::string>().c_str(),
                    100 * p["strain_mean"].get<double>(), 100 * p["strain_max"].get<double>());
        const char* before = "; curvature that would be taken away by";
        for (const auto& d : p["would_take"]) {
            out << before << text(" a %s of %.1f degrees to (%.3f, %.3f, %.3f)", d["kind"].get<std::string>().c_str(), std::abs(d["degrees"].get<double>()),
                                  d["point"][0].get<double>(), d["point"][1].get<double>(), d["point"][2].get<double>());
            before = ",";
        }
        out << '\n';
    }
    double off = 0;
    for (const auto& s : r["seams"]) off = std::max(off, std::abs(s["length_a"].get<double>() - s["length_b"].get<double>()));
    out << r["seams"].size() << text(" seams, whose sides differ by at most %.2f mm\n", 1000 * off);
    list_written(out, outcome.written);
}

int cut_command(const CutArguments& a, const Console& console) {
    set_threads(a.threads);
    const CutOutcome outcome = run_cut(a.job);
    if (a.json)
        console.out << outcome.report << std::flush;
    else if (!a.quiet)
        summarise(console.out, outcome);
    console.out << std::flush;
    return exit_made;
}

} // namespace

void add_cut(CLI::App& app, Command& chosen) {
    CLI::App& command = *app.add_subcommand("cut", "Cut a surface round a body along lines into a pattern");
    const auto a = std::make_shared<CutArguments>();
    CutJob& job = a->job;
    const auto file = [&command](const char* name, std::string& path, const char* help) {
        return command.add_option(name, path, help)->type_name("FILE");
    };
    file("body", job.body, "Body, or with --offset 0mm any mesh, which is cut itself")->required();
    file("--lines", job.lines, "Lines and the panels wanted, JSON as in docs/cut.md")->required();
    file("-o,--output", job.output, "Pattern to write")->required()->check([](const std::string& path) {
        return path.ends_with(".json") ? std::string() : path + " does not end in .json";
    });
    add_length(command, "offset", job.offset, 0, 0.2, "Distance of the surface from the body");
    add_length(command, "edge-length", job.edge, 0.002, 0.1, "Mean edge of the offset surface's mesh");
    file("--surface", job.surface, "Mesh to write of the pieces where they were cut, .obj or .glb");
    file("--preview", job.preview, "PNG to write: the strain left, from white to red");
    file("--report", job.report, "Report to write, JSON as in docs/cut.md");
    add_run_options(command, a->threads, a->quiet, a->json);
    command.callback([a, &chosen] { chosen = [a](const Console& console) { return cut_command(*a, console); }; });
}

} // namespace toile
