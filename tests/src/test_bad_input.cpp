// SPDX-License-Identifier: GPL-3.0-or-later
// Input that cannot be used: exit code 2, one sentence that says what is wrong, and nothing written.
#include "tests/src/run.h"

#include <catch2/catch.hpp>

#include <filesystem>

using namespace toile::test;
using Catch::Contains;

namespace {

/// The cube [0, 1]^3 scaled to a body of 1.7 m, closed.
const char* box_obj =
    "v -.1 0 -.1\nv .1 0 -.1\nv .1 1.7 -.1\nv -.1 1.7 -.1\nv -.1 0 .1\nv .1 0 .1\nv .1 1.7 .1\n"
    "v -.1 1.7 .1\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 1 5 8 4\nf 2 3 7 6\n";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const auto at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), by);
}

/// Drapes it with every kind of target and expects a refusal that leaves the folder as it was.
std::string refusal(const TempFolder& folder, const std::string& pattern, const std::string& avatar) {
    std::filesystem::create_directory(folder / "out");
    const Run r = run_toile({"drape", pattern, "--avatar", avatar, "--edge-length", "50mm", "-o",
                             folder / "out/a.obj", "-o", folder / "out/a.glb", "--report",
                             folder / "out/a.json", "--preview", folder / "out/a.png"});
    INFO(r.err);
    CHECK(r.code == 2);
    CHECK(one_sentence(r.err));
    CHECK(r.out.empty());
    CHECK(std::filesystem::is_empty(folder / "out"));
    return r.err;
}

std::string refused_pattern(const std::string& text) {
    const TempFolder folder;
    return refusal(folder, write_text(folder / "pattern.json", text),
                   write_text(folder / "body.obj", box_obj));
}

std::string refused_body(const std::string& name, const std::string& text) {
    const TempFolder folder;
    return refusal(folder, write_text(folder / "pattern.json", skirt_pattern()),
                   write_text(folder / name, text));
}

} // namespace

TEST_CASE("a pattern that is no JSON is refused") {
    CHECK_THAT(refused_pattern(""), Contains("empty"));
    CHECK_THAT(refused_pattern(skirt_pattern().substr(0, 300)), Contains("pattern.json"));
    CHECK_THAT(refused_pattern("solid stl\n"), Contains("JSON"));
    CHECK_THAT(refused_pattern(std::string("\0\xff\xfe", 3)), Contains("JSON"));
}

TEST_CASE("a pattern of wrong types or missing keys is refused with the place") {
    const std::string good = skirt_pattern();
    CHECK_THAT(refused_pattern("[]"), Contains("object"));
    CHECK_THAT(refused_pattern("{}"), Contains("pattern"));
    CHECK_THAT(refused_pattern(replaced(good, "\"vertices\"", "\"corners\"")), Contains("front"));
    CHECK_THAT(refused_pattern(replaced(good, "[0,1]", "\"0,1\"")), Contains("front"));
    CHECK_THAT(refused_pattern(replaced(good, "\"endpoints\":[0,1]", "\"endpoints\":[0,7]")),
               Contains("front"));
    CHECK_THAT(refused_pattern(replaced(good, "\"edge\":1", "\"edge\":9")), Contains("9"));
    CHECK_THAT(refused_pattern(replaced(good, "\"panel\":\"back\"", "\"panel\":\"sleeve\"")),
               Contains("sleeve"));
    CHECK_THAT(refused_pattern(replaced(good, "\"units_in_meter\": 100", "\"units_in_meter\": 0")),
               Contains("units_in_meter"));
}

TEST_CASE("numbers that are no lengths are refused") {
    const std::string good = skirt_pattern();
    refused_pattern(replaced(good, "[-30,0]", "[1e308,0]"));
    refused_pattern(replaced(good, "[-30,0]", "[1e999,0]"));
    refused_pattern(replaced(good, "[-30,0]", "[NaN,0]"));
    refused_pattern(replaced(good, "[-30,0]", "[null,0]"));
    CHECK_THAT(refused_pattern(skirt_pattern(29300, 29300)), Contains("293"));
}

TEST_CASE("panels and seams that cannot be sewn are refused") {
    const std::string good = skirt_pattern();
    CHECK_THAT(
        refused_pattern(R"({"pattern": {"panels": {"front": {"translation": [0,0,0], "rotation": [0,0,0],
        "vertices": [[0,0],[10,0]], "edges": [{"endpoints":[0,1]},{"endpoints":[1,0]}]}}, "stitches": []},
        "properties": {"units_in_meter": 100}})"),
        Contains("front"));
    CHECK_THAT(refused_pattern(replaced(good, R"([{"panel":"front","edge":1},{"panel":"back","edge":3}])",
                                        R"([{"panel":"front","edge":1},{"panel":"front","edge":1}])")),
               Contains("front"));
    CHECK_THAT(refused_pattern(
                   R"({"pattern": {"panels": {}, "stitches": []}, "properties": {"units_in_meter": 100}})"),
               Contains("panel"));
}

TEST_CASE("a pattern of ten million edges is refused by a stated limit") {
    std::string text =
        R"({"pattern": {"panels": {"front": {"translation": [0,0,0], "rotation": [0,0,0], "vertices": [[0,0]],
        "edges": [)";
    for (int i = 0; i < 10'000'000; ++i)
        text += R"({"endpoints":[0,0]},)";
    text.back() = ']';
    text += R"(}}, "stitches": []}, "properties": {"units_in_meter": 100}})";
    CHECK_THAT(refused_pattern(text), Contains("pattern.json"));
}

TEST_CASE("JSON nested 200,000 deep is refused") {
    CHECK_THAT(refused_pattern(std::string(200'000, '[') + std::string(200'000, ']')), Contains("deep"));
    std::string objects;
    for (int i = 0; i < 200'000; ++i)
        objects += "{\"a\":";
    refused_pattern(objects);
}

TEST_CASE("files that are no bodies are refused") {
    CHECK_THAT(refused_body("body.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), Contains("triangles"));
    CHECK_THAT(refused_body("body.obj", ""), Contains("body.obj"));
    CHECK_THAT(refused_body("body.glb", "this is no mesh"), Contains("body.glb"));
    CHECK_THAT(refused_body("body.txt", "hello"), Contains("body.txt"));
    // A lid is missing.
    CHECK_THAT(refused_body("body.obj", std::string(box_obj).substr(0, std::string(box_obj).find("f 2 3"))),
               Contains("hole"));
}

TEST_CASE("files that are not there and targets that cannot be written are refused before any work") {
    const TempFolder folder;
    const std::string pattern = write_text(folder / "pattern.json", skirt_pattern());
    const std::string body = write_text(folder / "body.obj", box_obj);
    const auto refuse = [&](std::vector<std::string> arguments) {
        const Run r = run_toile(arguments);
        INFO(r.err);
        CHECK(r.code == 2);
        CHECK(one_sentence(r.err));
        CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 2);
        return r.err;
    };
    CHECK_THAT(refuse({"drape", folder / "none.json", "-o", folder / "a.obj"}), Contains("none.json"));
    CHECK_THAT(refuse({"drape", pattern, "--avatar", folder / "none.obj", "-o", folder / "a.obj"}),
               Contains("none.obj"));
    CHECK_THAT(refuse({"drape", pattern, "--avatar", body, "-o", folder / "none/a.obj"}),
               Contains("none/a.obj"));
    CHECK_THAT(
        refuse({"drape", pattern, "--avatar", body, "-o", folder / "a.obj", "--report", folder.path()}),
        Contains("folder"));
    CHECK_THAT(refuse({"drape", pattern, "--avatar", body, "-o", body}), Contains("input"));
    CHECK_THAT(refuse({"drape", pattern, "--avatar", body, "-o", folder / "a.obj", "-o", folder / "a.obj"}),
               Contains("twice"));
    CHECK_THAT(refuse({"drape", pattern, "--avatar", body, "-o", folder / "a.obj", "--edge-length", "1mm",
                       "--from", folder / "none.obj"}),
               Contains("none.obj"));
    CHECK_THAT(refuse({"check", folder / "none.json"}), Contains("none.json"));
    CHECK_THAT(refuse({"flat", pattern, "-o", folder / "none/a.svg"}), Contains("none/a.svg"));
    CHECK_THAT(refuse({"inspect", folder / "none.obj"}), Contains("none.obj"));
    CHECK_THAT(refuse({"inspect", pattern}), Contains(".obj or .glb"));
    CHECK_THAT(refuse({"untangle", folder / "none.obj", "-o", folder / "a.obj"}), Contains("none.obj"));
    CHECK_THAT(refuse({"untangle", body, "-o", body}), Contains("input"));
    CHECK_THAT(refuse({"untangle", body, "--avatar", folder / "none.obj", "-o", folder / "a.obj"}), Contains("none.obj"));
    CHECK_THAT(refuse({"untangle", pattern, "-o", folder / "a.obj"}), Contains(".obj or .glb"));
    CHECK_THAT(refuse({"compare", body, folder / "none.obj"}), Contains("none.obj"));
    CHECK_THAT(refuse({"form", "-o", folder / "none/form.obj"}), Contains("none/form.obj"));
}
