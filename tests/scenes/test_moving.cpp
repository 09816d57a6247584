// SPDX-License-Identifier: GPL-3.0-or-later
// Dressed bodies that move.
#include "io/read_garment.h"
#include "io/read_avatar.h"
#include "io/write_file.h"
#include "src/pipeline.h"
#include "tests/src/run.h"
#include "tests/support/pose.h"
#include "tests/support/read_cache.h"
#include "tests/support/schema.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <numbers>

using namespace toile;
using namespace toile::test;
using Catch::Contains;

namespace {

const std::string tee = TOILE_SOURCE_DIR "/examples/tee.json";
constexpr double degree = std::numbers::pi / 180;

/// Files arms.0003.obj and on, one for each angle by which the arms are raised.
std::vector<std::string> write_motion(const TempFolder& folder, const std::vector<double>& angles) {
    TriMesh form = make_form({});
    const TriMesh still = form;
    std::vector<std::string> files;
    for (const double angle : angles) {
        form.points = with_arms_raised(still, angle * degree);
        files.push_back(folder / ("arms.000" + std::to_string(3 + files.size()) + ".obj"));
        write_mesh(files.back(), form);
    }
    return files;
}

IntersectionCount crossings(const std::string& garment, const std::string& body) {
    const ReadGarment g = read_garment(garment);
    return count_intersections(node_triangles(g.garment), g.x, read_avatar(body).body);
}

} // namespace

TEST_CASE("a tee follows arms that come down from T to A pose and go up again", "[moving]") {
    const TempFolder folder;
    const auto files = write_motion(folder, {40, 25, 10, 0, 15});
    const Run r = run_toile({"drape", tee, "--avatar-sequence", folder / "arms.%04d.obj", "--edge-length", "30mm", "-o",
                             folder / "tee.obj", "--fps", "12.5", "--report", folder / "tee.json"});
    INFO(r.err);
    REQUIRE(r.code == 0);
    CHECK_THAT(r.out, Contains("frames: 4 followed, 4 converged"));
    const std::string text = read_file(folder / "tee.json", 1 << 24);
    CHECK(Schema("report.schema.json").complaints(text) == "");
    const auto report = nlohmann::json::parse(text);
    REQUIRE(report["frames"].size() == 4);
    CHECK_FALSE(std::filesystem::exists(folder / "tee.obj"));
    for (std::size_t k = 0; k < files.size(); ++k) {
        INFO(files[k]);
        const IntersectionCount n = crossings(folder / ("tee.000" + std::to_string(3 + k) + ".obj"), files[k]);
        CHECK(n.cloth_avatar == 0);
        CHECK(n.cloth_cloth == 0);
        if (k == 0) continue;
        const auto& row = report["frames"][k - 1];
        CHECK(row["frame"] == 3 + k);
        CHECK(row["status"] == "converged");
        CHECK(row["behind"] == 0.0);
        CHECK(row["residual"] <= report["tolerance"]);
    }
    // Point caches have what the numbered files have.
    const ReadFrames pc2 = read_pc2(folder / "tee.pc2", 12.5), mdd = read_mdd(folder / "tee.mdd");
    CHECK(farthest(pc2.frames, mdd.frames) == 0);
    REQUIRE(pc2.frames.size() == files.size());
    for (std::size_t k = 0; k < files.size(); ++k) {
        const Points x = read_garment(folder / ("tee.000" + std::to_string(3 + k) + ".obj")).x;
        CHECK(farthest({pc2.frames[k]}, {rounded_to_float(x)}) == 0);
        CHECK(mdd.times[k] == double(float(0.08 * double(k))));
    }
    // The sleeves came down with the arms and went up again.
    const auto hand_side = [&](int frame) {
        double widest = 0;
        for (const Vec3& p : read_garment(folder / ("tee.000" + std::to_string(frame) + ".obj")).x)
            widest = std::max(widest, p.x());
        return widest;
    };
    CHECK(hand_side(6) < hand_side(3) - 0.03);
    CHECK(hand_side(7) > hand_side(6) + 0.005);
}

TEST_CASE("a garment follows a body from an earlier drape, and a long way at once", "[moving]") {
    const TempFolder folder;
    const auto files = write_motion(folder, {0, 20});
    REQUIRE(run_toile({"drape", tee, "--avatar", files[0], "--edge-length", "40mm", "-o", folder / "a.obj", "--quiet"})
                .code == 0);
    const Run r = run_toile({"drape", tee, "--avatar-sequence", files[0], files[1], "--edge-length", "40mm", "--from",
                             folder / "a.obj", "-o", folder / "b.glb", "--json"});
    INFO(r.err);
    REQUIRE(r.code == 0);
    const auto report = nlohmann::json::parse(r.out);
    CHECK(report["frames"][0]["intersections"]["cloth_avatar"] == 0);
    CHECK(report["frames"][0]["intersections"]["cloth_cloth"] == 0);
    CHECK(report["frames"][0]["substeps"] > 5);
    CHECK(crossings(folder / "b.0004.glb", files[1]).cloth_avatar == 0);
}

TEST_CASE("a body cannot be given twice", "[moving]") {
    const Run r = run_toile({"drape", tee, "--avatar", "a.obj", "--avatar-sequence", "b.0001.obj", "-o", "c.obj"});
    CHECK(r.code == 1);
    CHECK_THAT(r.err, Contains("--avatar and --avatar-sequence both name the body"));
}

TEST_CASE("a drape that is stopped does not go on to the frames", "[moving]") {
    const TempFolder folder;
    const auto files = write_motion(folder, {0, 10});
    const Run r = run_toile({"drape", tee, "--avatar-sequence", files[0], files[1], "--edge-length", "40mm", "--max-seconds",
                             "0.2s", "--json"});
    CHECK(r.code == 3);
    const auto report = nlohmann::json::parse(r.out);
    CHECK(report["status"] == "limit");
    CHECK_FALSE(report.contains("frames"));
    CHECK(report["warnings"].dump().find("does not follow the sequence") != std::string::npos);
}
