// SPDX-License-Identifier: GPL-3.0-or-later
// Patterns whose files put panels through the body, or on the wrong side of an arm.
#include "draping/inspect.h"
#include "src/pipeline.h"
#include "tests/support/sound_drape.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>

using namespace toile;
using namespace toile::test;

TEST_CASE("skirts whose panels start in the body drape like others") {
    const std::array<std::string, 3> cases[] = {{"circle_skirt", "mean_female", "jersey"},
                                                {"rand_009", "mean_male", "poplin"}};
    for (const auto& [name, body, fabric] : cases) {
        INFO(name);
        const auto pattern = test_data("garmentcode/" + name + "_specification.json");
        const auto avatar = test_data("bodies/" + body + ".obj");
        if (!pattern || !avatar) return;
        DrapeJob job;
        job.pattern = *pattern;
        job.avatar = *avatar;
        job.fabric = fabric;
        job.edge_length = 0.04;
        const DrapeOutcome drape = run_job(job);
        INFO(drape.result.where);
        CHECK(drape.result.status == DrapeStatus::converged);
        const auto moved = [](const std::string& sentence) {
            return sentence.find("out of the body before sewing") != std::string::npos;
        };
        CHECK(std::any_of(drape.result.decisions.begin(), drape.result.decisions.end(), moved));
        const Garment& g = drape.result.garment;
        const Inspection i = inspect(g, drape.result.state.positions, drape.body,
                                     PanelFabrics(g.panel_names.size(), fabric_preset(fabric)));
        CHECK(i.intersections.cloth_avatar == 0);
        CHECK(i.intersections.cloth_cloth == 0);
        CHECK(i.seam_gap_max == 0);
        CHECK(i.pieces == 1);
    }
}

TEST_CASE("trousers that do not fit are too small and not slid off, wherever their waist ends") {
    const auto pattern = test_data("garmentcode/rand_007_specification.json");
    const auto avatar = test_data("bodies/mean_all.obj");
    if (!pattern || !avatar) return;
    for (const double edge_length : {0.02, 0.03}) {
        DrapeJob job;
        job.pattern = *pattern;
        job.avatar = *avatar;
        job.fabric = "poplin";
        job.edge_length = edge_length;
        const DrapeOutcome drape = run_job(job);
        CHECK(drape.result.status == DrapeStatus::too_small);
        CHECK_THAT(drape.result.where, Catch::Contains("cm are missing"));
    }
}

namespace {

using nlohmann::json;

/// Three quarters of a ring, open at the top, whose inner edge (3) is `girth` cm long; edges 0 and 2 are its straight ends.
json three_quarter_ring(double girth, double width) {
    const double r = girth / (1.5 * EIGEN_PI), s = r / std::sqrt(2), t = (r + width) / std::sqrt(2);
    const auto arc = [](double radius, int right) { return json{{"type", "circle"}, {"params", {radius, 1, right}}}; };
    return {{"vertices", {{-s, s}, {-t, t}, {t, t}, {s, s}}},
            {"edges",
             {{{"endpoints", {0, 1}}},
              {{"endpoints", {1, 2}}, {"curvature", arc(r + width, 1)}},
              {{"endpoints", {2, 3}}},
              {{"endpoints", {3, 0}}, {"curvature", arc(r, 0)}}}}};
}

json band(double length, double height) {
    return {{"vertices", {{-length / 2, 0}, {length / 2, 0}, {length / 2, height}, {-length / 2, height}}},
            {"edges",
             {{{"endpoints", {0, 1}}}, {{"endpoints", {1, 2}}}, {{"endpoints", {2, 3}}}, {{"endpoints", {3, 0}}}}}};
}

json seam(const char* a, int edge_a, const char* b, int edge_b) {
    const auto end = [](const char* panel, int edge) { return json{{"panel", panel}, {"edge", edge}}; };
    return json::array({end(a, edge_a), end(b, edge_b)});
}

json at(json panel, double y, double z) {
    panel["translation"] = {0, y, z};
    panel["rotation"] = {0, 0, 0};
    return panel;
}

/// The panel with its left on the right, as a back is beside its front.
json mirrored(json panel) {
    for (json& v : panel["vertices"]) v[0] = -v[0].get<double>();
    for (json& e : panel["edges"])
        if (e.contains("curvature")) e["curvature"]["params"][2] = 1 - e["curvature"]["params"][2].get<int>();
    return panel;
}

/// Front and back of a full skirt on a waistband, both flat, so that the arms lie between the sides that belong together.
json full_skirt() {
    const json ring = three_quarter_ring(36.5, 45);
    json waist = band(36.5, 4);
    waist["edges"][2]["label"] = "lower_interface";
    return {{"pattern",
             {{"panels",
               {{"skirt_front", at(ring, 91, 25)},
                {"skirt_back", at(mirrored(ring), 91, -25)},
                {"band_front", at(waist, 100, 20)},
                {"band_back", at(mirrored(waist), 100, -20)}}},
              {"stitches",
               {seam("band_front", 1, "band_back", 3), seam("band_front", 3, "band_back", 1),
                seam("band_front", 0, "skirt_front", 3), seam("band_back", 0, "skirt_back", 3),
                seam("skirt_front", 0, "skirt_back", 2), seam("skirt_front", 2, "skirt_back", 0)}}}},
            {"properties",
             {{"units_in_meter", 100}, {"curvature_coords", "relative"}, {"normalized_edge_loops", true}}}};
}

/// A full skirt with a gathered flounce, whose own sides would close round the arms while the skirt's wait.
json flounced_skirt() {
    json skirt = full_skirt();
    auto& panels = skirt["pattern"]["panels"];
    auto& stitches = skirt["pattern"]["stitches"];
    const json flounce = band(260, 4); // light, or the jersey of the waistband gives by more than it may
    panels["flounce_front"] = at(flounce, 40, 25);
    panels["flounce_back"] = at(mirrored(flounce), 40, -25);
    stitches.push_back(seam("skirt_front", 1, "flounce_front", 2));
    stitches.push_back(seam("skirt_back", 1, "flounce_back", 2));
    stitches.push_back(seam("flounce_front", 1, "flounce_back", 3));
    stitches.push_back(seam("flounce_front", 3, "flounce_back", 1));
    return skirt;
}

/// Drapes a skirt that must have been hung before its sides were sewn.
void drape_hung(const json& skirt) {
    const TempFolder folder;
    DrapeJob job;
    job.pattern = folder / "skirt.json";
    std::ofstream(job.pattern) << skirt;
    job.fabric = "jersey";
    job.edge_length = 0.03;
    job.garments = {folder / "a.obj"};
    // The insides of deep folds look at the body.
    const DrapeOutcome drape = drape_soundly(job, job.fabric, 0.1, 0.7);
    const auto hung = [](const std::string& sentence) { return sentence.find("hung down") != std::string::npos; };
    CHECK(std::any_of(drape.result.decisions.begin(), drape.result.decisions.end(), hung));
}

} // namespace

TEST_CASE("a full skirt whose sides start on either side of the arms is hung before they are sewn") { drape_hung(full_skirt()); }

TEST_CASE("the sides of a flounce wait with those of the full skirt that it hangs by") { drape_hung(flounced_skirt()); }
