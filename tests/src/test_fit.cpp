// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_pattern.h"
#include "tests/src/run.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>

using namespace toile;
using namespace toile::test;
using Catch::Matchers::Contains;

namespace {

const std::string skirt = TOILE_SOURCE_DIR "/examples/skirt.json";

std::string up(const std::string& panel, int vertex) {
    return R"({"name": ")" + panel + ' ' + std::to_string(vertex) + R"(", "panel": ")" + panel + R"(", "vertex": )" +
           std::to_string(vertex) + R"(, "direction": [0, 1], "low": -60, "high": 60})";
}

/// The middle of the hem and its corners, each panel by itself: two side seams have to stay equal.
const std::string hem = R"("alterations": [)" + up("front", 0) + "," + up("back", 0) + "," + up("front", 1) + "," + up("back", 12) + "," +
                        up("front", 12) + "," + up("back", 1) + "]";
const std::string hem_edges = R"([["front", 0], ["front", 12], ["back", 0], ["back", 12]])";

std::string level_at(double height, double tolerance) {
    return R"({"name": "hem", "level": )" + hem_edges + ", \"height\": " + std::to_string(height) +
           ", \"tolerance\": " + std::to_string(tolerance) + "}";
}

std::string spec(const std::string& goals, const std::string& more = "") { return "{" + hem + ", \"goals\": [" + goals + "]" + more + "}"; }

std::vector<std::string> arguments(const TempFolder& folder, const std::string& text) {
    return {"fit", skirt, "--spec", write_text(folder / "fit.json", text), "--edge-length", "60mm", "--json"};
}

} // namespace

TEST_CASE("fit: a hem comes to the height that is asked for, seams stay equal, and the pattern can be read and cut") {
    const TempFolder folder;
    std::vector<std::string> words = arguments(folder, spec(level_at(520, 8)));
    for (const char* word : {"-o", "new.json", "--picture", "new.svg", "--report", "report.json", "--garment", "new.obj"})
        words.push_back(word[0] == '-' ? word : folder / word);
    const Run r = run_toile(words);
    CAPTURE(r.err);
    REQUIRE(r.code == 0);
    const auto report = nlohmann::json::parse(r.out);
    CHECK(report["status"] == "met");
    CHECK(report["goals"][0]["before"] > 0.02);
    CHECK(report["goals"][0]["after"] < 0.008);
    CHECK(report["optimiser"] == "slsqp");
    CHECK(report["seams"]["kept"] == 2);
    CHECK(report["seams"]["unequal_mm"] < 0.02);
    CHECK(report["draped_anew"]["misses"][0] < 0.012);
    const Pattern before = read_pattern(skirt), after = read_pattern(folder / "new.json");
    CHECK(after.fabric == before.fabric); // from the file beside it
    for (int k = 0; k < 2; ++k) {
        const double moved = after.panels[k].outline[0].start.y() - before.panels[k].outline[0].start.y();
        CHECK(moved == Approx(1e-3 * report["alterations"][k]["mm"].get<double>()));
    }
    for (const char* file : {"new.svg", "report.json", "new.obj"}) CHECK(std::filesystem::exists(folder / file));
}

TEST_CASE("fit: goals that contradict each other or are out of reach get the nearest and a sentence") {
    const TempFolder folder;
    const auto nearest = [&](const std::string& goals) {
        const Run r = run_toile(arguments(folder, spec(goals)));
        CAPTURE(r.err);
        CHECK(r.code == 3);
        CHECK(one_sentence(r.err));
        CHECK_THAT(r.err, Contains("\"hem\" is missed by"));
        return nlohmann::json::parse(r.out);
    };
    auto report = nearest(level_at(900, 5)); // above the hips
    CHECK(report["status"] == "nearest");
    CHECK(report["alterations"][0]["at_bound"] == true);
    CHECK(report["alterations"][0]["mm"] == Approx(60));

    report = nearest(level_at(515, 1) + "," + level_at(535, 1));
    CHECK(report["status"] == "nearest");
    CHECK(report["goals"][0]["after"].get<double>() + report["goals"][1]["after"].get<double>() >= 0.0199);
}

TEST_CASE("fit: what cannot be used is refused in a sentence") {
    const TempFolder folder;
    const auto refused = [&](const std::string& text, const std::string& why) {
        const Run r = run_toile(arguments(folder, text));
        CHECK(r.code == 2);
        CHECK(one_sentence(r.err));
        CHECK_THAT(r.err, Contains(why));
    };
    const std::string one = R"({"name": "a", "panel": "front", "vertex": 0, "direction": [0, 1], )";
    const std::string goals = R"(, "goals": [)" + level_at(520, 5) + "]}";
    refused(R"({"alterations": [)" + one + R"("low": 10, "high": 20}])" + goals,
            "alteration \"a\" starts at 0 mm, outside of its bounds 10 and 20 mm");
    refused(R"({"alterations": [)" + one + R"("low": 5, "high": -5}])" + goals, "nowhere to go");
    refused(R"({"alterations": [{"name": "a", "panel": "front", "vertex": 1, "direction": [0, 1], "low": -5, "high": 5}])" + goals,
            "alter both sides of each alike");
    refused(spec(level_at(520, 5), R"(, "optimiser": "bfgs")"), "\"slsqp\", \"lbfgs\" or \"cobyla\"");
    refused(spec(R"({"shape": "none.obj", "tolerance": 1})"), "none.obj");
    refused(spec(R"({"ease": 40, "height": 100, "tolerance": 1})"), "has no girth at 100 mm");
    refused(R"({"alterations": [{"name": "a", "panel": "sleeve", "vertex": 0, "direction": [0, 1], "low": -5, "high": 5}])" + goals,
            "the name of a panel");
    refused(R"({"alterations": [{"name": "a", "panel": "front", "edge": 1, "control": 1, "direction": [0, 1], "low": -5, "high": 5}])" +
                goals,
            "edge 1 of panel front has no control point 1");
    refused(R"({"alterations": [{"name": "a\nb", "panel": "front", "vertex": 0, "direction": [0, 1], "low": -5, "high": 5}])" + goals,
            "a name of 1 to 80 characters on one line");
    refused(spec(""), "goals");
    CHECK(run_toile({"fit", skirt, "--spec", folder / "fit.json"}).code == 1); // nothing to write
}
