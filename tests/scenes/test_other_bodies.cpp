// SPDX-License-Identifier: GPL-3.0-or-later
// The examples cut to the measures of bodies of another make: quads, another topology, another pose.
#include "io/read_avatar.h"
#include "tests/support/sound_drape.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <fstream>

using namespace toile;
using namespace toile::test;

namespace {

const std::vector<std::string> bodies = {"bodies/mh_female_young_average.obj", "bodies/mh_male_young_average.obj"};

bool has_python() {
    if (std::system("python3 --version > /dev/null 2>&1") == 0) return true;
    WARN("skipped: there is no python3");
    return false;
}

void run_script(const std::string& line) {
    REQUIRE(std::system((TOILE_SOURCE_DIR "/scripts/" + line).c_str()) == 0);
}

/// What the script measures on a body, in the file it is written to.
std::string measured(const std::string& body, const TempFolder& folder) {
    run_script("measure_body.py '" + body + "' > '" + (folder / "body.json") + "'");
    return folder / "body.json";
}

} // namespace

TEST_CASE("the examples cut to other bodies drape on them") {
    if (!has_python()) return;
    for (const std::string& name : bodies) {
        const auto body = test_data(name);
        if (!body) return;
        const TempFolder folder;
        run_script("make_examples.py --body '" + measured(*body, folder) + "' --out '" + folder.path() + "'");
        for (const auto& [garment, fabric] : {std::pair{"tee", "jersey"}, {"skirt", "wool"}, {"trousers", "linen"}}) {
            INFO(garment << " on " << name);
            DrapeJob job;
            job.pattern = folder / (std::string(garment) + ".json");
            job.avatar = *body;
            job.edge_length = 0.03;
            job.garments = {folder / "a.obj", folder / "a.glb"};
            // Triangles of 30 mm are coarse for what jersey does under a slender arm.
            const DrapeOutcome drape = drape_soundly(job, fabric, 0.12);
            for (const Landmark& l : drape.result.landmarks)
                CHECK(std::abs(l.settled - l.placed) < 0.03);
        }
    }
}

TEST_CASE("the script measures a body as the program does") {
    if (!has_python()) return;
    for (const std::string& name : bodies) {
        const auto path = test_data(name);
        if (!path) return;
        INFO(name);
        const TempFolder folder;
        std::ifstream file(measured(*path, folder));
        const auto script = nlohmann::json::parse(file);
        const BodyMeasures program = measure_body(read_avatar(*path).body);
        CHECK(script["bust"].get<double>() == Approx(100 * program.bust).margin(1));
        CHECK(script["waist"].get<double>() == Approx(100 * program.waist).margin(0.5));
        CHECK(script["hip"].get<double>() == Approx(100 * program.hip).margin(0.5));
        CHECK(script["waist_y"].get<double>() == Approx(100 * program.waist_y).margin(1.5));
        CHECK(script["crotch_y"].get<double>() == Approx(100 * program.crotch_y).margin(1));
        CHECK(script["armpit_y"].get<double>() == Approx(100 * program.armpit_y).margin(1.5));
    }
}
