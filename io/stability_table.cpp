// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/stability_table.h"

#include "geometry/text.h"
#include "io/markup.h"
#include "io/stability_svg.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace toile {

namespace {

std::string status(const StabilityRun& run) { return run.outcome.failure.empty() ? "works" : run.outcome.failure; }

/// JSON has no infinity.
nlohmann::ordered_json finite(double value) { return std::isfinite(value) ? nlohmann::ordered_json(value) : nullptr; }

} // namespace

std::string stability_csv(const std::vector<StabilityMap>& maps) {
    std::string csv = "method,scene,mesh,seed,stiffness,axis,value,boundary,measure,status\n";
    for (const StabilityMap& map : maps)
        for (const StabilityRun& run : map.runs)
            csv += std::string(to_string(map.scene.method)) + ',' + csv_field(map.scene.name) + ',' + to_string(run.mesh.kind) +
                   text(",%d,%.6g,", run.mesh.seed, run.stiffness) + csv_field(map.scene.axis) +
                   text(",%.6g,%.6g,%.6g,", run.value, run.boundary, run.outcome.measure) + csv_field(status(run)) + '\n';
    return csv;
}

std::string stability_json(const std::vector<StabilityMap>& maps, const std::string& version) {
    nlohmann::ordered_json json;
    json["toile_stability"] = 1;
    json["version"] = version;
    json["maps"] = nlohmann::ordered_json::array();
    for (const StabilityMap& map : maps) {
        const StabilityScene& s = map.scene;
        const StabilityCount count = compare_with_theory(map, theory_band);
        nlohmann::ordered_json runs = nlohmann::ordered_json::array();
        for (const StabilityRun& run : map.runs)
            runs.push_back({{"mesh", to_string(run.mesh.kind)}, {"seed", run.mesh.seed}, {"stiffness", run.stiffness}, {"value", run.value},
                            {"boundary", finite(run.boundary)}, {"measure", finite(run.outcome.measure)}, {"status", status(run)}});
        json["maps"].push_back({{"method", to_string(s.method)}, {"scene", s.name}, {"what", s.what}, {"axis", s.axis}, {"unit", s.unit},
                                {"measure", s.measure}, {"theory", s.theory}, {"fails", s.fails_above ? "above" : "below"}, {"failed", count.failed},
                                {"as_theory", count.as_theory}, {"earlier", count.earlier}, {"later", count.later},
                                {"near_boundary", count.left_out}, {"runs", std::move(runs)}});
    }
    return json.dump(1) + '\n';
}

std::string stability_page(const std::vector<StabilityMap>& maps, const std::string& version) {
    std::string page = "<p>" + escaped(version) + text(". Where each method works, over the stiffness of stretch (times length squared over that of the plate) and what else matters "
                            "to it, on strips meshed in three ways and jittered. Runs within a factor of %g of the boundary are not held against theory.</p>\n",
                            theory_band);
    page += "<table>\n<tr><th>map</th><th>boundary</th><th>runs</th><th>failed</th><th>as theory says</th><th>earlier</th><th>later</th></tr>\n";
    for (const StabilityMap& map : maps) {
        const StabilityCount c = compare_with_theory(map, theory_band);
        page += "<tr><td>" + escaped(map_title(map)) + "</td><td class=\"words\">" + escaped(map.scene.theory) +
                text("</td><td>%zu</td><td>%d</td><td>%d</td><td>%d</td><td>%d</td></tr>\n", map.runs.size(), c.failed, c.as_theory, c.earlier, c.later);
    }
    page += "</table>\n";
    for (const StabilityMap& map : maps) page += "<section>\n<p>" + escaped(map.scene.what) + "</p>\n" + stability_svg(map) + "</section>\n";
    return html_page("Stability", page);
}

} // namespace toile
