// SPDX-License-Identifier: GPL-3.0-or-later
// Ten real garments on the bodies they were made for, from file to files.
#include "io/read_avatar.h"
#include "src/pipeline.h"
#include "tests/support/sound.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

using namespace toile;
using namespace toile::test;

namespace {

void drape_soundly(const std::string& name, const std::string& body, const std::string& fabric) {
    const auto pattern = test_data("garmentcode/" + name + "_specification.json");
    const auto avatar = test_data("bodies/" + body + ".obj");
    if (!pattern || !avatar) return;
    const TempFolder folder;
    DrapeJob job;
    job.pattern = *pattern;
    job.avatar = *avatar;
    job.fabric = fabric;
    job.edge_length = 0.03;
    job.garments = {folder / "a.obj", folder / "a.glb"};
    const DrapeOutcome drape = run_job(job);
    INFO(drape.result.where);
    CHECK(drape.result.status == DrapeStatus::converged);
    for (const std::string& file : job.garments) {
        const ReadGarment g = read_garment(file);
        // Triangles of 30 mm are coarse for gathers and necks; ruffles and open fronts turn over here and there.
        check_sound(g, drape.body, PanelFabrics(g.garment.panel_names.size(), fabric_preset(fabric)), 0.1, 0.95);
    }
}

} // namespace

TEST_CASE("real tshirt drapes") { drape_soundly("tshirt", "mean_all", "poplin"); }
TEST_CASE("real fitted shirt with darts drapes") { drape_soundly("fitted_shirt_darts", "mean_female", "jersey"); }
TEST_CASE("real turtleneck drapes") { drape_soundly("turtleneck", "mean_all", "jersey"); }
TEST_CASE("real hoody drapes") { drape_soundly("hoody_mean", "mean_all", "jersey"); }
TEST_CASE("real open cardigan drapes") { drape_soundly("openfront_cardigan", "mean_all", "poplin"); }
TEST_CASE("real strapless top drapes") { drape_soundly("strapless_top", "mean_female", "jersey"); }
TEST_CASE("real skirt with godets drapes") { drape_soundly("godet_skirt", "mean_female", "jersey"); }
TEST_CASE("real ruffled skirt drapes") { drape_soundly("two_panel_skirt_ruffled", "mean_all", "poplin"); }
TEST_CASE("real short trousers drape") { drape_soundly("shorts", "mean_male", "poplin"); }
TEST_CASE("real jumpsuit drapes") { drape_soundly("jumpsuit", "mean_all", "jersey"); }
