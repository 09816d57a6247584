// SPDX-License-Identifier: GPL-3.0-or-later
// Real patterns whose files put panels through the body.
#include "draping/inspect.h"
#include "src/pipeline.h"
#include "tests/support/test_data.h"

#include <catch2/catch.hpp>

#include <algorithm>

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
