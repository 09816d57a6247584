// SPDX-License-Identifier: GPL-3.0-or-later
// Real garments on the bodies they were made for, from file to files.
#include "tests/support/sound_drape.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

#include <algorithm>
#include <optional>

using namespace toile;
using namespace toile::test;

namespace {

/// A pattern on a body, both of the test data; nothing where there is none.
std::optional<DrapeJob> real_job(const std::string& pattern, const std::string& body, const std::string& fabric, double edge_length) {
    const auto file = test_data(pattern), avatar = test_data("bodies/" + body + ".obj");
    if (!file || !avatar) return std::nullopt;
    DrapeJob job;
    job.pattern = *file;
    job.avatar = *avatar;
    job.fabric = fabric;
    job.edge_length = edge_length;
    return job;
}

void drape_real(const std::string& name, const std::string& body, const std::string& fabric) {
    auto job = real_job("garmentcode/" + name + "_specification.json", body, fabric, 0.03);
    if (!job) return;
    const TempFolder folder;
    job->garments = {folder / "a.obj", folder / "a.glb"};
    // Triangles of 30 mm are coarse for gathers and necks; ruffles and open fronts turn over here and there.
    drape_soundly(*job, fabric, 0.1, 0.95);
}

} // namespace

TEST_CASE("real tshirt drapes") { drape_real("tshirt", "mean_all", "poplin"); }
TEST_CASE("real fitted shirt with darts drapes") { drape_real("fitted_shirt_darts", "mean_female", "jersey"); }
TEST_CASE("real turtleneck drapes") { drape_real("turtleneck", "mean_all", "jersey"); }
TEST_CASE("real hoody drapes") { drape_real("hoody_mean", "mean_all", "jersey"); }
TEST_CASE("real open cardigan drapes") { drape_real("openfront_cardigan", "mean_all", "poplin"); }
TEST_CASE("real strapless top drapes") { drape_real("strapless_top", "mean_female", "jersey"); }
TEST_CASE("real skirt with godets drapes") { drape_real("godet_skirt", "mean_female", "jersey"); }
TEST_CASE("real ruffled skirt drapes") { drape_real("two_panel_skirt_ruffled", "mean_all", "poplin"); }
TEST_CASE("real short trousers drape") { drape_real("shorts", "mean_male", "poplin"); }
TEST_CASE("real jumpsuit drapes") { drape_real("jumpsuit", "mean_all", "jersey"); }

// Drawn shut all at once, their waist is drawn above the hips and the crotch into the body; and nothing but their fit carries them.
TEST_CASE("real trousers without labels sit at the waist") {
    auto job = real_job("garmentcode_2021/pants_straight_sides.json", "f_smpl_template", "jersey", 0.03);
    if (!job) return;
    const TempFolder folder;
    job->garments = {folder / "a.obj"};
    const DrapeOutcome drape = run_job(*job);
    INFO(drape.result.where);
    REQUIRE(drape.result.status == DrapeStatus::converged);
    const auto top = std::max_element(drape.result.state.positions.begin(), drape.result.state.positions.end(),
                                      [](const Vec3& a, const Vec3& b) { return a.y() < b.y(); });
    CHECK(top->y() > -0.2); // the hips are widest at -0.31 m, the waist at -0.05 m slightest
    CHECK(top->y() < 0);
}

// One side of its collar is sewn through the front and comes out only as a mesh of its own. (The file turns the sides of its
// collars over, so that the look for turned sides does not apply.)
TEST_CASE("a real collar that stays tangled comes apart") {
    auto job = real_job("garmentcode/rand_005_specification.json", "mean_all", "poplin", 0.02);
    if (!job) return;
    const TempFolder folder;
    job->garments = {folder / "a.obj"};
    const DrapeOutcome drape = run_job(*job);
    INFO(drape.result.where);
    CHECK(drape.result.status == DrapeStatus::converged);
    const ReadGarment g = read_garment(job->garments[0]);
    const Inspection i = inspect(g.garment, g.x, drape.body, PanelFabrics(g.garment.panel_names.size(), fabric_preset("poplin")));
    CHECK(i.intersections.cloth_avatar == 0);
    CHECK(i.intersections.cloth_cloth == 0);
    CHECK(i.seam_gap_max == 0);
    CHECK(i.strain.weft.max <= i.strain.limit_weft);
}
