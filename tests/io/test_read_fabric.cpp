// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_fabric.h"

#include "io/companion.h"
#include "io/read_pattern.h"
#include "tests/support/schema.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>

#include <fstream>
#include <sstream>

using namespace toile;
using Catch::Matchers::Contains;

namespace {

const std::string full = R"({
  "toile_fabric": 1, "name": "interlock", "source": "a strip test", "like": "jersey",
  "stretch_warp": [[0, 0], [0.05, 4], [0.1, 15], [0.2, 70]],
  "stretch_weft": 60,
  "density": 0.2, "shear": 30, "limit_warp": 0.4
})";

std::string replaced(std::string text, const std::string& a, const std::string& b) {
    const auto at = text.find(a);
    REQUIRE(at != std::string::npos);
    return text.replace(at, a.size(), b);
}

Fabric read(const std::string& text) {
    std::istringstream in(text);
    return read_fabric(in, "mine.json");
}

std::string refusal(const std::string& text) {
    try {
        read(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return "read";
}

std::string with_warp(const std::string& points) {
    return refusal(replaced(full, "[[0, 0], [0.05, 4], [0.1, 15], [0.2, 70]]", points));
}

} // namespace

TEST_CASE("a fabric file is a preset with what differs from it") {
    const Fabric f = read(full), jersey = fabric_preset("jersey");
    CHECK(f.name == "interlock");
    CHECK(f.source == "a strip test");
    CHECK(f.curve_warp == std::vector<StretchPoint>{{0, 0}, {0.05, 4}, {0.1, 15}, {0.2, 70}});
    CHECK(f.stretch_warp == Approx(150)); // the secant at 10 %
    CHECK(f.curve_weft.empty());
    CHECK(f.stretch_weft == 60);
    CHECK(f.density == 0.2);
    CHECK(f.shear == 30);
    CHECK(f.limit_warp == 0.4);
    CHECK(f.limit_weft == jersey.limit_weft);
    CHECK(f.bend_warp == jersey.bend_warp);
    CHECK(test::Schema("fabric.schema.json").complaints(full) == "");
    CHECK(fabric_called("rib").name == "rib");
    CHECK_THROWS_AS(fabric_called("velvet"), std::invalid_argument);
    CHECK_THROWS_AS(fabric_called("/nowhere/velvet.json"), InputError);
}

TEST_CASE("what a fabric file gets wrong is named") {
    CHECK(refusal(full) == "read");
    CHECK_THAT(refusal(replaced(full, "jersey", "velvet")), Contains("\"like\": there is no fabric \"velvet\""));
    CHECK_THAT(refusal(replaced(full, "density", "weight")), Contains("unknown key \"weight\""));
    CHECK_THAT(refusal(replaced(full, "\"density\": 0.2", "\"density\": -0.2")), Contains("\"density\" must be a number from 0.001 to 10"));
    CHECK_THAT(refusal(replaced(full, ": 60", ": \"soft\"")),
               Contains("\"stretch_weft\" must be a stiffness in N/m or a list of points [stretch, tension in N/m]"));
    CHECK_THAT(with_warp("[[0, 0]]"), Contains("\"stretch_warp\": a stretch curve has 1 points: expected 2 to 1000"));
    CHECK_THAT(with_warp("[[0.01, 0], [0.1, 4]]"), Contains("begins at (0.01, 0): expected (0, 0)"));
    CHECK_THAT(with_warp("[[0, 0], [0.1, 4], [0.05, 8]]"),
               Contains("point 2 of a stretch curve, (0.05, 8), follows (0.1, 4): expected both stretch and tension to rise"));
    CHECK_THAT(with_warp("[[0, 0], [0.1, 4], [0.2, 4]]"), Contains("expected both stretch and tension to rise"));
    CHECK_THAT(with_warp("[[0, 0], [0.1, 1e999]]"), Contains("mine.json"));
    CHECK_THAT(with_warp("[[0, 0], [0.1, null]]"), Contains("point 1, number 1"));
    CHECK_THAT(with_warp("[[0, 0], [0.1, 4, 5]]"), Contains("point 1"));
    CHECK_THAT(with_warp("[[0, 0], [0.1, 4], [0.9, 4.01]]"), Contains("expected tension / (1 + stretch) to rise"));
    CHECK_THAT(refusal(R"({"toile_fabric": 1, "name": "n", "like": "rib", "stretch_warp": 1, "poisson": 0.4})"),
               Contains("mine.json: fabric \"n\": stretch_warp, stretch_weft and shear must be positive"));
}

TEST_CASE("a companion may name a file of a fabric beside it") {
    const test::TempFolder folder;
    std::ofstream(folder / "mine.json") << full;
    std::ofstream(folder / "shirt.toile.json") << R"({"toile": 1, "fabric": "mine.json"})";
    Pattern pattern;
    read_companion(folder / "shirt.toile.json", pattern);
    CHECK(fabric_called(pattern.fabric).name == "interlock");
    CHECK(test::Schema("companion.schema.json").complaints(R"({"toile": 1, "fabric": "mine.json"})") == "");
    CHECK(test::Schema("companion.schema.json").complaints(R"({"toile": 1, "fabric": "mine"})") != "");
    std::ofstream(folder / "shirt.toile.json") << R"({"toile": 1, "fabric": "other.json"})";
    CHECK_THROWS_WITH(read_companion(folder / "shirt.toile.json", pattern), Contains("other.json"));
}
