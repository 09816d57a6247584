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

TEST_CASE("stability writes a page with its data and pictures") {
    const TempFolder folder;
    const Run r = run_toile({"stability", "--quick", "--method", "springs-limited", "-o", folder / "map.html"});
    INFO(r.err);
    REQUIRE(r.code == exit_made);
    CHECK_THAT(r.out, Contains("springs-limited: swing: ") && Contains(" as theory says, "));

    std::istringstream csv(read_file(folder / "map.csv", 1 << 20));
    std::string line;
    std::getline(csv, line);
    CHECK(line == "method,scene,mesh,seed,stiffness,axis,value,boundary,measure,status");
    int rows = 0, failed = 0;
    for (; std::getline(csv, line); ++rows) {
        CHECK_THAT(line, Catch::Matchers::StartsWith("springs-limited,"));
        failed += !line.ends_with(",works");
    }
    CHECK(rows == 3 * 6 * 6 * 7); // maps, meshes, stiffnesses, values
    CHECK(failed > 0);
    CHECK(failed < rows);

    const auto json = nlohmann::json::parse(read_file(folder / "map.json", 1 << 22));
    CHECK(json["toile_stability"] == 1);
    REQUIRE(json["maps"].size() == 3);
    for (const auto& map : json["maps"]) {
        CHECK(map["runs"].size() == 6 * 6 * 7);
        CHECK(map["failed"] > 0);
    }

    const std::string page = read_file(folder / "map.html", 1 << 22), picture = read_file(folder / "map-springs-limited-swing.svg", 1 << 20);
    CHECK_THAT(page, Contains("<svg") && !Contains("<script") && !Contains("<link"));
    CHECK_THAT(picture, Catch::Matchers::StartsWith("<svg") && Contains("of 6 meshes work") && Contains("blew up") && Contains("boundary by theory"));
}

TEST_CASE("stability is the same for any number of threads") {
    const TempFolder folder;
    for (const char* n : {"1", "2"})
        REQUIRE(run_toile({"stability", "--quick", "--quiet", "--threads", n, "--method", "springs-explicit", "-o", folder / n + std::string(".html")}).code == exit_made);
    CHECK(read_file(folder / "1.csv", 1 << 20) == read_file(folder / "2.csv", 1 << 20));
}

TEST_CASE("stability refuses what it does not know") {
    const TempFolder folder;
    CHECK(run_toile({"stability", "--method", "rubber", "-o", folder / "map.html"}).code == exit_command_line);
    CHECK(run_toile({"stability", "-o", folder / "map.txt"}).code == exit_command_line);
    CHECK(run_toile({"stability"}).code == exit_command_line);
    CHECK(run_toile({"stability", "--quick", "-o", folder / "none/map.html"}).code == exit_refused);
}
