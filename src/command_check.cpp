// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/command_line.h"

#include "geometry/text.h"
#include "io/read_pattern.h"
#include "patterns/check.h"
#include "src/drape_input.h"
#include "src/quantity.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <ostream>

namespace toile {
namespace {

using Json = nlohmann::ordered_json;

struct CheckArguments {
    std::string pattern;
    bool json = false;
};

const char* to_word(Severity severity) {
    return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

/// The seams that can be measured: one that names nothing has no length.
std::vector<Seam> measurable(const Pattern& pattern) {
    const auto known = [&](const EdgeSpan& s) {
        return s.panel >= 0 && s.panel < int(pattern.panels.size()) && s.edge >= 0 &&
               s.edge < int(pattern.panels[s.panel].outline.size());
    };
    std::vector<Seam> seams;
    for (const Seam& seam : pattern.seams)
        if (std::all_of(seam.a.begin(), seam.a.end(), known) &&
            std::all_of(seam.b.begin(), seam.b.end(), known))
            seams.push_back(seam);
    return seams;
}

void print_seams(std::ostream& out, const Pattern& pattern) {
    out << "seams (length of both sides, ease):\n";
    for (const Seam& seam : measurable(pattern)) {
        const SeamLengths lengths = seam_lengths(pattern, seam);
        out << text("%9.1f mm %9.1f mm %7.1f %%  ", 1000 * lengths.a, 1000 * lengths.b, 100 * lengths.ease)
            << seam.name << '\n';
    }
}

void print_json(std::ostream& out, const Pattern& pattern, const std::vector<Issue>& issues) {
    Json json{{"issues", Json::array()}, {"seams", Json::array()}};
    for (const Issue& issue : issues)
        json["issues"].push_back({{"severity", to_word(issue.severity)}, {"text", issue.text}});
    for (const Seam& seam : measurable(pattern)) {
        const SeamLengths lengths = seam_lengths(pattern, seam);
        json["seams"].push_back(
            {{"name", seam.name}, {"a", lengths.a}, {"b", lengths.b}, {"ease", lengths.ease}});
    }
    out << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
}

/// What a staged mesh holds. Reading it refuses what cannot be draped.
int check_staged(const CheckArguments& a, const Console& console) {
    const DrapeInput input = read_staged_input(a.pattern, "", {});
    const Garment& g = input.staging.levels[0].garment;
    const Points& x = input.staging.levels[0].placed;
    std::vector<int> triangles(g.panel_names.size(), 0), stitches(input.staging.seam_names.size(), 0);
    std::vector<double> gap(stitches.size(), 0);
    for (const int panel : g.panel_of_triangle)
        ++triangles[panel];
    int inside = 0;
    for (const Stitch& s : g.stitches) {
        inside += s.r > 0;
        ++stitches[s.seam];
        gap[s.seam] = std::max(gap[s.seam], stitch_gap(s, x));
    }
    Json json{{"issues", Json::array()}, {"panels", Json::array()}, {"seams", Json::array()}};
    for (const std::string& note : input.notes)
        json["issues"].push_back({{"severity", "note"}, {"text", note}});
    for (std::size_t p = 0; p < triangles.size(); ++p)
        json["panels"].push_back({{"name", g.panel_names[p]}, {"triangles", triangles[p]}});
    for (std::size_t s = 0; s < stitches.size(); ++s)
        json["seams"].push_back({{"name", input.staging.seam_names[s]}, {"stitches", stitches[s]}, {"gap", gap[s]}});
    if (a.json) {
        console.out << json.dump(2, ' ', false, Json::error_handler_t::replace) << std::endl;
        return exit_made;
    }
    for (const std::string& note : input.notes)
        console.out << "note: " << note << '\n';
    for (std::size_t p = 0; p < triangles.size(); ++p)
        console.out << "panel " << g.panel_names[p] << ": " << triangles[p] << " triangles\n";
    for (std::size_t s = 0; s < stitches.size(); ++s)
        console.out << input.staging.seam_names[s] << ": " << stitches[s] << " stitches, "
                    << show_length(gap[s]) << " apart at most\n";
    console.out << triangles.size() << " panels, " << g.stitches.size() << " stitches, " << inside
                << " of them to the inside of an edge\n" << std::flush;
    return exit_made;
}

int check_command(const CheckArguments& a, const Console& console) {
    if (is_staged(a.pattern)) return check_staged(a, console);
    const Pattern pattern = read_pattern(a.pattern);
    const std::vector<Issue> issues = check(pattern);
    int errors = 0, warnings = 0;
    for (const Issue& issue : issues) {
        errors += issue.severity == Severity::error;
        warnings += issue.severity == Severity::warning;
    }
    if (a.json) {
        print_json(console.out, pattern, issues);
    } else {
        for (const Issue& issue : issues)
            console.out << to_word(issue.severity) << ": " << issue.text << '\n';
        print_seams(console.out, pattern);
        console.out << pattern.panels.size() << " panels, " << pattern.seams.size() << " seams, " << errors
                    << " errors, " << warnings << " warnings\n";
    }
    console.out << std::flush;
    return errors ? exit_refused : exit_made;
}

} // namespace

void add_check(CLI::App& app, Command& chosen) {
    CLI::App& command = *app.add_subcommand("check", "Say everything that is wrong with a pattern");
    const auto a = std::make_shared<CheckArguments>();
    command.add_option("pattern", a->pattern, "Pattern, or a staged mesh (.obj)")->required()->type_name("FILE");
    command.add_flag("--json", a->json, "Print JSON");
    command.callback(
        [a, &chosen] { chosen = [a](const Console& console) { return check_command(*a, console); }; });
}

} // namespace toile
