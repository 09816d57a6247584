// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/text.h"
#include "io/read_pattern.h"
#include "io/write_file.h"
#include "patterns/shrink.h"
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

TEST_CASE("fit: a band and steam are fitted, written beside the pattern, and draped from there") {
    const TempFolder folder;
    const std::string pattern = write_text(folder / "skirt.json", read_file(skirt, 1 << 20));
    write_text(folder / "skirt.toile.json", R"({"toile": 1, "fabric": "jersey",
        "elastics": [{"label": "lower_interface", "ratio": 1, "stiffness": 60}]})");
    const std::string text = write_text(folder / "fit.json", R"({"alterations": [
        {"name": "band", "elastic": "lower_interface", "low": -250, "high": 0},
        {"name": "steam", "unit": "percent", "low": 0, "high": 8,
         "moves": [{"panel": "front", "shrink": "warp"}, {"panel": "back", "shrink": "warp"}]}],
        "goals": [{"name": "hem", "level": )" + hem_edges + R"(, "height": 520, "tolerance": 14}]})");
    const Run r = run_toile({"fit", pattern, "--spec", text, "--edge-length", "60mm", "--json", "-o", folder / "new.json"});
    CAPTURE(r.err);
    REQUIRE(r.code == 0);
    const auto report = nlohmann::json::parse(r.out);
    CHECK(report["optimiser"] == "lbfgs");
    CHECK(report["goals"][0]["before"] > 0.02);
    CHECK(report["edges"].empty());
    CHECK(report["seams"]["eased"].empty()); // both sides shrink
    const double steam = report["alterations"][1]["percent"].get<double>();
    CHECK(steam > 1);
    const Pattern after = read_pattern(folder / "new.json");
    CHECK(after.fabric == "jersey");
    CHECK(after.panels[1].shrink.y() == Approx(steam / 100));
    double relaxed = 0, said = 0;
    for (const auto& e : report["elastics"]) said += e["relaxed_after_mm"].get<double>();
    for (const Elastic& e : after.elastics) relaxed += e.ratio * length_at_rest(after, e.span);
    CHECK(said == Approx(1e3 * relaxed));
    const Run draped = run_toile({"drape", folder / "new.json", "--edge-length", "60mm", "--json"});
    CHECK_THAT(draped.out, Contains(toile::text("elastic bands of %.1f cm relaxed", 100 * relaxed)));
}

TEST_CASE("fit: an elastic is put in where there was none, and the companion that says so is new") {
    const TempFolder folder;
    const std::string pattern = write_text(folder / "skirt.json", read_file(skirt, 1 << 20));
    const std::string text = write_text(folder / "fit.json", R"({"alterations": [
        {"name": "band", "panel": "back", "elastic": "lower_interface", "stiffness": 80, "unit": "percent", "low": -40, "high": 0, "start": -20}],
        "goals": [{"name": "hem", "level": )" + hem_edges + R"(, "tolerance": 50}]})");
    const Run r = run_toile({"fit", pattern, "--spec", text, "--edge-length", "60mm", "--json", "-o", folder / "new.json"});
    CAPTURE(r.err);
    REQUIRE(r.code == 0);
    const Pattern after = read_pattern(folder / "new.json");
    REQUIRE(after.elastics.size() == 3);
    for (const Elastic& e : after.elastics) {
        CHECK(e.span.panel == 1);
        CHECK(e.stiffness == 80);
        CHECK(e.ratio == Approx(1 + nlohmann::json::parse(r.out)["alterations"][0]["percent"].get<double>() / 100));
    }
}

TEST_CASE("fit: a seam may be eased where that is asked for, and is no further") {
    const TempFolder folder;
    // A corner of the hem that one panel alone has: seam 0 joins edge 1 of the front, which it shortens, to the back's.
    const std::string corner = R"({"name": "corner", "panel": "front", "vertex": 1, "direction": [0, 1], "low": -30, "high": 30})";
    const std::string goal = R"(], "goals": [{"name": "hem", "level": [["front", 0]], "tolerance": 8}]})";
    const std::string ease = R"(, {"name": "ease", "ease": 0, "low": -12, "high": 12})";
    const Run r = run_toile(arguments(folder, R"({"alterations": [)" + corner + ease + goal));
    CAPTURE(r.err);
    const auto report = nlohmann::json::parse(r.out);
    CHECK(report["goals"][0]["after"] < report["goals"][0]["before"]);
    CHECK(report["seams"]["unequal_mm"] < 0.02);
    const double eased = report["alterations"][1]["mm"];
    CHECK(std::abs(eased) > 1);
    CHECK(std::abs(eased) <= 12);
    REQUIRE(report["seams"]["eased"].size() == 1);
    const auto& seam = report["seams"]["eased"][0];
    CHECK_THAT(seam["seam"].get<std::string>(), Contains("seam 0"));
    CHECK(std::abs(seam["a_mm"].get<double>() - seam["b_mm"].get<double>()) == Approx(std::abs(eased)).margin(0.1));
}

TEST_CASE("fit: rest lengths that cannot be had are refused in a sentence") {
    const TempFolder folder;
    const std::string pattern = write_text(folder / "skirt.json", read_file(skirt, 1 << 20));
    const auto refused = [&](const std::string& alterations, const std::string& why) {
        const std::string text = write_text(folder / "fit.json", "{\"alterations\": [" + alterations + "], \"goals\": [" + level_at(520, 5) + "]}");
        const Run r = run_toile({"fit", pattern, "--spec", text, "--edge-length", "60mm", "--json"});
        CHECK(r.code == 2);
        CHECK(one_sentence(r.err));
        CHECK_THAT(r.err, Contains(why));
    };
    const std::string band = R"({"name": "band", "elastic": "lower_interface", "low": )";
    refused(band + R"(-50, "high": 0})", "\"elastic\" must be where the companion file has an elastic");
    write_text(folder / "skirt.toile.json", R"({"toile": 1, "elastics": [{"label": "lower_interface", "ratio": 0.9}]})");
    refused(band + R"(-50, "high": 200})", "\"band\" may make the elastic on edge 3 of panel front from ");
    refused(band + R"(-10, "high": 0, "unit": "percent"}, {"name": "more", "panel": "front", "elastic": 3, "low": -90, "high": 0, "unit": "percent"})",
            "\"band\" and \"more\" may make the elastic on edge 3 of panel front from -0.1 to 0.9 times");
    refused(R"({"name": "a", "panel": "front", "elastic": 2, "low": -1, "high": 0})", "must be where the companion file has an elastic");
    refused(R"({"name": "a", "elastic": "waist", "low": -1, "high": 0})", "\"elastic\" must be the label of an edge, but is \"waist\"");
    refused(band + R"(-9, "high": 0, "stiffness": 50})", "\"stiffness\" must be left out where there is an elastic already");
    refused(R"({"name": "a", "elastic": 3, "low": -1, "high": 0})", "lacks the key \"panel\"");
    refused(R"({"name": "a", "panel": "front", "shrink": "warp", "low": 0, "high": 3})", "needs \"unit\": \"percent\"");
    refused(R"({"name": "a", "panel": "front", "shrink": "bias", "unit": "percent", "low": 0, "high": 3})", "\"warp\", \"weft\" or \"both\"");
    refused(R"({"name": "a", "panel": "front", "shrink": "both", "unit": "percent", "low": 0, "high": 60})",
            "\"a\" may shrink panel front from 0 to 60 % along its weft, expected -50 to 50");
    refused(R"({"name": "a", "panel": "front", "vertex": 0, "direction": [0, 1], "unit": "percent", "low": 0, "high": 3})",
            "outlines move by mm");
    refused(band + R"(-5, "high": 0, "unit": "inch"})", "\"mm\" or \"percent\"");
    refused(band + R"(-5, "high": 5, "start": 9})", "alteration \"band\" starts at 9 mm, outside of its bounds -5 and 5 mm");
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
