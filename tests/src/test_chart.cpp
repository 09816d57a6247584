// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/write_file.h"
#include "tests/src/run.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <sstream>

using namespace toile;
using namespace toile::test;
using Catch::Matchers::Contains;

TEST_CASE("chart writes a page with its data and pictures") {
    const TempFolder folder;
    const Run r = run_toile({"chart", "--quick", "--scene", "catenary", "--method", "springs-implicit", "--method", "projective", "-o", folder / "chart.html"});
    INFO(r.err);
    REQUIRE(r.code == exit_made);
    CHECK_THAT(r.out, Contains("catenary: within 5 %: "));

    std::istringstream csv(read_file(folder / "chart.csv", 1 << 20));
    std::string line;
    std::getline(csv, line);
    CHECK(line == "scene,method,edge_length,step,error,error_solver,seconds_cpu,seconds_wall,status");
    int rows = 0;
    for (; std::getline(csv, line); ++rows) CHECK_THAT(line, Catch::Matchers::StartsWith("catenary,") && Catch::Matchers::EndsWith(",converged"));
    CHECK(rows == 6);

    const auto json = nlohmann::json::parse(read_file(folder / "chart.json", 1 << 20));
    CHECK(json["toile_chart"] == 1);
    CHECK(json["points"].size() == 6);
    CHECK(json["points"][0]["method"] == "springs-implicit");
    CHECK(json["points"][0]["value"].get<double>() == Approx(0.50595).epsilon(1e-3)); // a chain of ten links

    const std::string page = read_file(folder / "chart.html", 1 << 20), picture = read_file(folder / "chart-catenary.svg", 1 << 20);
    CHECK_THAT(page, Contains("<svg") && !Contains("http://localhost") && !Contains("<script src") && !Contains("<link"));
    CHECK_THAT(picture, Catch::Matchers::StartsWith("<svg") && Contains("springs-implicit, edges of 30 mm") && Contains("1 %"));
}

TEST_CASE("chart draws what a scene with a band measures") {
    const TempFolder folder;
    const Run r = run_toile({"chart", "--quick", "--scene", "cusick", "--method", "springs-implicit", "-o", folder / "chart.html"});
    INFO(r.err);
    REQUIRE(r.code == exit_made);
    const auto json = nlohmann::json::parse(read_file(folder / "chart.json", 1 << 20));
    CHECK(json["scenes"][0]["band"].size() == 2);
    CHECK_THAT(read_file(folder / "chart-cusick-disc.svg", 1 << 20), Contains("drape coefficient: 0.27 to 0.521 by Cusick") && !Contains("1 %"));
}

TEST_CASE("chart holds a garment against its own finest equilibrium") {
    const TempFolder folder;
    const Run r = run_toile({"chart", "--quick", "--max-seconds", "60s", "--pattern", TOILE_SOURCE_DIR "/examples/tee.json", "--scene", "tee", "--method",
                             "equilibrium", "-o", folder / "chart.html"});
    INFO(r.err);
    REQUIRE(r.code == exit_made);
    const auto points = nlohmann::json::parse(read_file(folder / "chart.json", 1 << 20))["points"];
    REQUIRE(points.size() == 3);
    double before = 0.2; // 20 mm
    for (const auto& p : points) {
        CHECK(p["status"] == "converged");
        CHECK(p["error"].get<double>() > 0.001); // it is not held against itself
        CHECK(p["error"].get<double>() < before);
        before = p["error"].get<double>();
    }
    CHECK(before < 0.05);
}

TEST_CASE("chart refuses what it does not know") {
    const TempFolder folder;
    const Run scene = run_toile({"chart", "--scene", "hat", "-o", folder / "chart.html"});
    CHECK(scene.code == exit_refused);
    CHECK_THAT(scene.err, Contains("no scene begins with 'hat', the scenes are 'cantilever, aligned, 1e04'"));
    CHECK(!std::filesystem::exists(folder / "chart.html"));
    CHECK(run_toile({"chart", "--pattern", folder / "none.json", "-o", folder / "chart.html"}).code == exit_refused);
    CHECK(run_toile({"chart", "--method", "rubber", "-o", folder / "chart.html"}).code == exit_command_line);
    CHECK(run_toile({"chart", "-o", folder / "chart.txt"}).code == exit_command_line);
    CHECK(run_toile({"chart", "--quick", "-o", folder / "none/chart.html"}).code == exit_refused);
}
