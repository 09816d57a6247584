// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include "geometry/parallel.h"
#include "geometry/text.h"
#include "src/moulded_job.h"
#include "src/options.h"
#include "src/rest_job.h"
#include "src/sag_free_job.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <memory>
#include <ostream>

namespace toile {
namespace {

struct RestArguments {
    RestJob job;
    std::string fabric, hold;
    double length_change = 5, angle_change = 90; // %, degrees
    bool sag_free = false, moulded = false;
    int threads = 0;
    bool quiet = false, json = false, keep_energy = false;
};

void refuse_useless(const RestArguments& a) {
    const RestJob& job = a.job;
    if (job.output.empty() && job.rest.empty() && job.report.empty() && job.preview.empty() && !a.json)
        throw CommandLineError("there is nothing to write: name a file with -o, --rest, --preview or --report");
    if (a.keep_energy && job.relax) throw CommandLineError("--keep-energy and --relax exclude each other");
    if (!a.fabric.empty() && job.length_weight > 0)
        throw CommandLineError("--fabric and --length-weight exclude each other");
    if (job.all_states && job.output.empty()) throw CommandLineError("--all-states writes meshes beside that of -o, which is not named");
    if (!job.output.empty()) refuse_formats({job.output});
}

void summarise(std::ostream& out, const RestOutcome& outcome) {
    const auto r = nlohmann::json::parse(outcome.report);
    const auto& d = r["data"];
    out << "data: " << d["lengths"] << " lengths and " << d["angles"] << " angles, ";
    if (!d["rank"].is_null()) out << d["rank"] << " of them independent, ";
    out << "on " << d["freedom"] << " degrees of freedom\n";
    if (r["misfit"]["at"].is_null())
        out << "misfit: none\n";
    else
        out << text("misfit: up to %.3g degrees round point ", r["misfit"]["max"].get<double>()) << r["misfit"]["at"] << ", at "
            << r["misfit"]["points"].size() << " of " << d["inner_points"] << " inner points\n";
    for (std::size_t k = 0; k < r["states"].size(); ++k) {
        const auto& s = r["states"][k];
        out << "state " << k + 1 << text(": energy %.10g J, lengths off by up to %.2g %%, angles by %.3g degrees",
                                         s["energy"].get<double>(), 100 * s["length_off_max"].get<double>(),
                                         s["angle_off_max"].get<double>());
        if (!s["mirror_of"].is_null()) out << ", the mirror of state " << s["mirror_of"];
        out << '\n';
    }
    list_written(out, outcome.written);
}

void refuse_with_sag_free(const RestArguments& a) {
    const RestJob& job = a.job;
    if (a.hold.empty())
        throw CommandLineError("--sag-free needs --hold: numbers of points such as 1,2,3, \"borders\", or a file of numbers");
    if (!job.output.empty()) throw CommandLineError("--sag-free moves nothing: it writes a rest shape with --rest, and no mesh with -o");
    if (!job.lengths_of.empty() || !job.angles_of.empty() || !job.data.empty() || job.length_weight > 0 || job.relax || a.keep_energy)
        throw CommandLineError("--sag-free finds lengths and angles itself: --lengths-of, --angles-of, --data, --length-weight, "
                               "--keep-energy and --relax do not go with it");
}

void summarise(std::ostream& out, const SagFreeOutcome& outcome) {
    const auto r = nlohmann::json::parse(outcome.report);
    out << text("weight: %.4g N\n", r["weight"].get<double>());
    out << text("residual force: up to %.3g N", r["residual"]["max"].get<double>());
    if (!r["residual"]["points"].empty())
        out << ", at point " << r["residual"]["at"] << "; " << r["residual"]["points"].size() << " points lack some";
    if (r["stable"] == false) out << "\nnot stable: the least push takes the cloth elsewhere";
    out << text("\nlengths changed by up to %.3g %%, angles by %.3g degrees; ", 100 * std::abs(r["length_change"]["max"].get<double>()),
                std::abs(r["angle_change"]["max"].get<double>()));
    out << r["bounds"]["lengths"].size() << " lengths and " << r["bounds"]["angles"].size() << " angles at their bounds\n";
    list_written(out, outcome.written);
}

int sag_free_command(const RestArguments& arguments, const Console& console) {
    refuse_with_sag_free(arguments);
    SagFreeJob job;
    job.shape = arguments.job.shape;
    job.hold = arguments.hold;
    if (!arguments.fabric.empty()) job.fabric = arguments.fabric;
    job.options.length_change = arguments.length_change / 100;
    job.options.angle_change = arguments.angle_change * M_PI / 180;
    job.rest = arguments.job.rest;
    job.preview = arguments.job.preview;
    job.report = arguments.job.report;
    const SagFreeOutcome outcome = run_sag_free(job);
    if (arguments.json)
        console.out << outcome.report << std::flush;
    else if (!arguments.quiet)
        summarise(console.out, outcome);
    console.out << std::flush;
    if (outcome.found.end == BalanceEnd::balanced) return exit_made;
    const auto residual = nlohmann::json::parse(outcome.report)["residual"];
    const char* what = outcome.found.end == BalanceEnd::nearest ? "no rest shape within the bounds holds the cloth"
                                                               : "stalled before the nearest rest shape was found";
    console.err << text("toile: %s: point %d lacks %.3g N", what, residual["at"].get<int>(), residual["max"].get<double>())
                << std::endl;
    return exit_not_converged;
}

void refuse_with_moulded(const RestArguments& a) {
    const RestJob& job = a.job;
    if (a.sag_free) throw CommandLineError("--moulded and --sag-free exclude each other");
    if (!job.rest.empty() || !job.lengths_of.empty() || !job.angles_of.empty() || !job.data.empty() || job.length_weight > 0 ||
        job.relax || a.keep_energy)
        throw CommandLineError("--moulded takes the mesh as the rest shape: --lengths-of, --angles-of, --data, --length-weight, "
                               "--rest, --keep-energy and --relax do not go with it");
}

void summarise(std::ostream& out, const MouldedOutcome& outcome) {
    const auto r = nlohmann::json::parse(outcome.report);
    for (std::size_t k = 0; k < r["states"].size(); ++k) {
        const auto& s = r["states"][k];
        out << "state " << k + 1 << text(": energy %.10g J, angles up to %.3g degrees from those moulded", s["energy"].get<double>(),
                                         s["angle_off_max"].get<double>());
        if (!s["mirror_of"].is_null()) out << ", the mirror of state " << s["mirror_of"];
        out << '\n';
    }
    if (r["unsettled"] > 0) out << r["unsettled"] << " of " << r["starts"] << " starts did not come to rest\n";
    list_written(out, outcome.written);
}

int moulded_command(const RestArguments& arguments, const Console& console) {
    refuse_with_moulded(arguments);
    MouldedJob job;
    job.shape = arguments.job.shape;
    if (!arguments.fabric.empty()) job.fabric = arguments.fabric;
    job.output = arguments.job.output;
    job.all_states = arguments.job.all_states;
    job.preview = arguments.job.preview;
    job.report = arguments.job.report;
    const MouldedOutcome outcome = run_moulded(job);
    if (arguments.json)
        console.out << outcome.report << std::flush;
    else if (!arguments.quiet)
        summarise(console.out, outcome);
    console.out << std::flush;
    if (!outcome.states.found.empty()) return exit_made;
    console.err << "toile: stalled: from no start did the cloth come to rest" << std::endl;
    return exit_not_converged;
}

int rest_command(const RestArguments& arguments, const Console& console) {
    refuse_useless(arguments);
    set_threads(arguments.threads);
    if (arguments.moulded) return moulded_command(arguments, console);
    if (arguments.sag_free) return sag_free_command(arguments, console);
    RestJob job = arguments.job;
    if (!arguments.fabric.empty()) job.fabric = arguments.fabric;
    const RestOutcome outcome = run_rest(job);
    if (arguments.json)
        console.out << outcome.report << std::flush;
    else if (!arguments.quiet)
        summarise(console.out, outcome);
    console.out << std::flush;
    if (!outcome.states.empty()) return exit_made;
    console.err << "toile: stalled: no start reached a minimum" << std::endl;
    return exit_not_converged;
}

} // namespace

void add_rest(CLI::App& app, Command& chosen) {
    CLI::App& command = *app.add_subcommand("rest", "Find the nearest shapes to lengths and angles that need not fit together");
    const auto a = std::make_shared<RestArguments>();
    RestJob& job = a->job;
    const auto file = [&command](const char* name, std::string& path, const char* help) {
        return command.add_option(name, path, help)->type_name("FILE");
    };
    file("shape", job.shape, "Mesh, .obj or .glb: its lengths and angles, and the shape to start from")->required();
    file("--lengths-of", job.lengths_of, "Mesh of the same triangles whose lengths are wanted instead");
    file("--angles-of", job.angles_of, "Mesh of the same triangles whose angles are wanted instead");
    file("--data", job.data, "JSON file that changes some lengths and angles, as in docs/rest.md");
    add_fabric(command, a->fabric, "Fabric that weighs lengths against angles (default: poplin)");
    command.add_option("--length-weight", job.length_weight, "Weight of every length, where every angle has 1 (default: by the fabric)")
        ->check(CLI::Range(1e-9, 1e12).description(""))
        ->type_name("NUMBER");
    command.add_flag("--keep-energy", a->keep_energy, "The rest shape stays what was asked for, and its energy frozen in (default)");
    command.add_flag("--relax", job.relax, "The rest shape is what the nearest shape measures: no energy is left");
    command.add_flag("--moulded", a->moulded, "The mesh is how cloth of this fabric was moulded: find all shapes in which it stays");
    CLI::Option* sag_free = command.add_flag("--sag-free", a->sag_free, "Find the rest shape with which cloth of this fabric hangs as the mesh lies, gravity along -y");
    command.add_option("--hold", a->hold, "With --sag-free, what is held: points by number, 1,2,3, or \"borders\", or a file of numbers")
        ->needs(sag_free)
        ->type_name("POINTS");
    command.add_option("--length-change", a->length_change, "With --sag-free, most that a length may change (default 5 %)")
        ->check(CLI::Range(0.0, 50.0).description(""))
        ->needs(sag_free)
        ->type_name("PERCENT");
    command.add_option("--angle-change", a->angle_change, "With --sag-free, most that an angle may change (default 90 degrees)")
        ->check(CLI::Range(0.0, 180.0).description(""))
        ->needs(sag_free)
        ->type_name("DEGREES");
    file("-o,--output", job.output, "Mesh to write of the lowest state");
    command.add_flag("--all-states", job.all_states, "Write the other states beside it as name-2, name-3 ...");
    file("--rest", job.rest, "Rest shape to write, JSON as --data");
    file("--preview", job.preview, "PNG to write: how little what was asked for fits, from white to red");
    file("--report", job.report, "Report to write, JSON as in docs/rest.md");
    add_run_options(command, a->threads, a->quiet, a->json);
    command.callback([a, &chosen] { chosen = [a](const Console& console) { return rest_command(*a, console); }; });
}

} // namespace toile
