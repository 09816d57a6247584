// SPDX-License-Identifier: GPL-3.0-or-later
// Patterns whose files put panels through the body, or on the wrong side of an arm.
#include "draping/inspect.h"
#include "src/pipeline.h"
#include "tests/support/full_skirt.h"
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
    const std::array<std::string, 4> cases[] = {
        {"circle_skirt", "mean_female", "jersey", "laid round the body in pleats before sewing"},
        {"rand_009", "mean_male", "poplin", "out of the body before sewing"}};
    for (const auto& [name, body, fabric, how] : cases) {
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
        const auto moved = [&](const std::string& sentence) { return sentence.find(how) != std::string::npos; };
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

/// Drapes a skirt that must have been laid round the body before its sides were sewn.
void drape_wrapped(const nlohmann::json& skirt) {
    const TempFolder folder;
    DrapeJob job;
    job.pattern = folder / "skirt.json";
    std::ofstream(job.pattern) << skirt;
    job.fabric = "jersey";
    job.edge_length = 0.03;
    job.garments = {folder / "a.obj"};
    // The insides of deep folds look at the body.
    const DrapeOutcome drape = drape_soundly(job, job.fabric, 0.1, 0.7);
    const auto laid = [](const std::string& sentence) { return sentence.find("laid round the body in pleats") != std::string::npos; };
    CHECK(std::any_of(drape.result.decisions.begin(), drape.result.decisions.end(), laid));
}

} // namespace

TEST_CASE("a full skirt whose sides start on either side of the arms is laid round the body before they are sewn") { drape_wrapped(full_skirt()); }

TEST_CASE("a flounce is laid round with the full skirt that it hangs by") { drape_wrapped(flounced_skirt()); }
