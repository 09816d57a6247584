// SPDX-License-Identifier: GPL-3.0-or-later
// Whatever bytes come in: a sentence or a pattern, never a crash.
#include "io/companion.h"
#include "io/flat_svg.h"
#include "io/read_pattern.h"
#include "io/read_staged.h"
#include "patterns/check.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

using namespace toile;

namespace {

const std::string specification = R"({"pattern": {"panels": {
  "front": {"translation": [10, 20, 30], "rotation": [0, 0, 0], "label": "body", "vertices": [[0, 0], [50, 0], [50, 40], [0, 40]],
    "edges": [{"endpoints": [0, 1], "label": "hem"}, {"endpoints": [1, 2], "curvature": {"type": "quadratic", "params": [[0.5, 0.1]]}},
      {"endpoints": [2, 3], "curvature": {"type": "cubic", "params": [[0.25, -0.1], [0.75, -0.2]]}},
      {"endpoints": [3, 0], "curvature": {"type": "circle", "params": [25, 0, 1]}}]},
  "back": {"translation": [0, 0, -30], "rotation": [0, 180, 0], "vertices": [[0, 0], [0, 40], [50, 40], [50, 0]],
    "edges": [{"endpoints": [0, 1]}, {"endpoints": [1, 2], "curvature": [0.5, 0.1]}, {"endpoints": [2, 3]}, {"endpoints": [3, 0]}]}},
  "stitches": [[{"panel": "front", "edge": 1}, {"panel": "back", "edge": 0}], [{"panel": "front", "edge": 3}, {"panel": "back", "edge": 2}, "right_wrong"]]},
 "properties": {"units_in_meter": 100, "curvature_coords": "relative", "normalize_panel_translation": false}})";

const std::string companion =
    R"({"toile": 1, "fabric": "poplin", "panels": {"front": {"grain": 45, "layer": 1,
  "holes": [{"vertices": [[10, 10], [15, 10], [10, 15]]}], "lines": [{"vertices": [[20, 20], [30, 20]], "kind": "fold", "angle": 90}]}},
  "pins": [{"panel": "back", "edge": 3, "from": 0.25, "to": 0.5}], "elastics": [{"label": "hem", "ratio": 0.8}],
  "seams": [{"a": {"panel": "front", "edge": 0}, "b": [{"panel": "back", "edge": 3, "to": 0.25}]}]})";

enum class Outcome { refused, read };

/// Reads, checks and draws; anything thrown but InputError fails the test.
Outcome outcome(const std::string& text) {
    try {
        std::istringstream in(text);
        const Pattern p = read_pattern(in, "x.json");
        if (!has_error(check(p))) CHECK(!flat_svg(p).empty());
        return Outcome::read;
    } catch (const InputError& e) {
        const std::string what = e.what();
        CHECK(what.size() > 10);
        CHECK(what.size() < 400);
        CHECK(what.find('\n') == std::string::npos);
        return Outcome::refused;
    }
}

Outcome companion_outcome(const Pattern& base, const std::string& text) {
    Pattern p = base;
    try {
        std::istringstream in(text);
        read_companion(in, "x.toile.json", p);
        check(p);
        return Outcome::read;
    } catch (const InputError&) {
        return Outcome::refused;
    }
}

Outcome staged_outcome(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
    try {
        const StagedMesh s = read_staged(path);
        CHECK(s.positions.size() == std::size_t(s.garment.node_count));
        return Outcome::read;
    } catch (const InputError&) {
        return Outcome::refused;
    }
}

std::string mutated(std::string text, std::mt19937& random) {
    const auto pick = [&](std::size_t n) { return std::size_t(random() % n); };
    for (std::size_t k = 1 + pick(3); k-- > 0 && !text.empty();) {
        const std::size_t at = pick(text.size());
        switch (pick(5)) {
        case 0:
            text[at] = char(random());
            break;
        case 1:
            text.erase(at, 1 + pick(20));
            break;
        case 2:
            text.insert(at, text.substr(pick(text.size()), 1 + pick(30)));
            break;
        case 3:
            text[at] = "0123456789.-+eE[]{},:\"ntf/"[pick(26)];
            break;
        default:
            text.insert(at, std::string(1 + pick(3), "9e-0"[pick(4)]));
        }
    }
    return text;
}

/// A random place of the document gets a random value: valid JSON with wrong content.
void corrupt(nlohmann::json& j, std::mt19937& random) {
    nlohmann::json* at = &j;
    while (at->is_structured() && !at->empty() && random() % 8 != 0)
        at = &*std::next(at->begin(), int(random() % at->size()));
    static const nlohmann::json values[] = {nullptr,
                                            true,
                                            -1,
                                            0,
                                            1,
                                            2,
                                            3,
                                            1e308,
                                            -1e308,
                                            1e-300,
                                            0.5,
                                            4294967296,
                                            18446744073709551615u,
                                            "x",
                                            "front",
                                            "circle",
                                            nlohmann::json::array(),
                                            nlohmann::json::object(),
                                            {1, 2},
                                            {{1, 2}, {3, 4}},
                                            1e5,
                                            -25.0};
    *at = values[random() % std::size(values)];
}

} // namespace

TEST_CASE("a specification cut short anywhere is refused") {
    for (std::size_t n = 0; n < specification.size(); ++n)
        CHECK(outcome(specification.substr(0, n)) == Outcome::refused);
    CHECK(outcome(specification) == Outcome::read);
}

TEST_CASE("mutated specifications are refused or read") {
    std::mt19937 random(1);
    int read = 0, refused = 0;
    for (int i = 0; i < 4000; ++i)
        (outcome(mutated(specification, random)) == Outcome::read ? read : refused)++;
    CHECK(read > 100);
    CHECK(refused > 1000);
}

TEST_CASE("specifications with wrong values are refused or read") {
    std::mt19937 random(2);
    const nlohmann::json good = nlohmann::json::parse(specification);
    int read = 0, refused = 0;
    for (int i = 0; i < 4000; ++i) {
        nlohmann::json bad = good;
        for (unsigned k = 0; k <= random() % 2; ++k)
            corrupt(bad, random);
        (outcome(bad.dump()) == Outcome::read ? read : refused)++;
    }
    CHECK(read > 100);
    CHECK(refused > 1000);
}

TEST_CASE("mutated companions are refused or read") {
    std::istringstream in(specification);
    const Pattern base = read_pattern(in, "x.json");
    std::mt19937 random(3);
    const nlohmann::json good = nlohmann::json::parse(companion);
    CHECK(companion_outcome(base, companion) == Outcome::read);
    int refused = 0;
    for (int i = 0; i < 3000; ++i) {
        refused += companion_outcome(base, mutated(companion, random)) == Outcome::refused;
        nlohmann::json bad = good;
        corrupt(bad, random);
        refused += companion_outcome(base, bad.dump()) == Outcome::refused;
    }
    CHECK(refused > 1000);
    CHECK(refused < 6000);
}

TEST_CASE("mutated staged meshes are refused or read") {
    std::string mesh;
    for (const char* line :
         {"v 0 0 0.2",     "v 1 0 0.2",     "v 1 1 0.2",        "v 0 1 0.2",     "v 0 0 -0.2",
          "v 1 0 -0.2",    "v 1 1 -0.2",    "v 0 1 -0.2",       "vt 0 0",        "vt 1 0",
          "vt 1 1",        "vt 0 1",        "vt 2 0",           "vt 3 0",        "vt 3 1",
          "vt 2 1",        "g front",       "f 1/1 2/2 3/3",    "f 1/1 3/3 4/4", "g back",
          "f 5/5 6/6 7/7", "f 5/5 7/7 8/8", "stitch 7 1 2 0.5", "l 2 5",         "l 3 8"})
        mesh += std::string(line) + "\n";
    const test::TempFolder folder;
    CHECK(staged_outcome(folder / "x.obj", mesh) == Outcome::read);
    std::mt19937 random(4);
    int refused = 0;
    for (int i = 0; i < 800; ++i)
        refused += staged_outcome(folder / "x.obj", mutated(mesh, random)) == Outcome::refused;
    CHECK(refused > 100);
    CHECK(refused < 800);
}

TEST_CASE("real specifications with wrong values are refused or read") {
    const auto folder = test::test_data("garmentcode");
    if (!folder) return;
    std::mt19937 random(5);
    for (const char* file : {"tshirt", "lapel_top", "godet_skirt"}) {
        std::ifstream in(*folder + "/" + file + "_specification.json");
        const nlohmann::json good = nlohmann::json::parse(in);
        for (int i = 0; i < 150; ++i) {
            nlohmann::json bad = good;
            corrupt(bad["pattern"], random);
            outcome(bad.dump());
        }
    }
}
