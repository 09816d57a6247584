// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/companion.h"

#include "draping/fabric/fabric.h"
#include "io/read_pattern.h"
#include "patterns/check.h"
#include "tests/support/schema.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>

#include <fstream>
#include <sstream>

using namespace toile;
using Catch::Matchers::Contains;

namespace {

const char* const pattern_text = R"({
  "pattern": {
    "panels": {
      "front": {"translation": [0, 0, 20], "rotation": [0, 0, 0], "vertices": [[0, 0], [50, 0], [50, 50], [0, 50]],
        "edges": [{"endpoints": [0, 1], "label": "hem"}, {"endpoints": [1, 2]}, {"endpoints": [2, 3], "label": "waist"}, {"endpoints": [3, 0]}]},
      "back": {"translation": [0, 0, -20], "rotation": [0, 0, 0], "vertices": [[0, 0], [0, 50], [50, 50], [50, 0]],
        "edges": [{"endpoints": [0, 1]}, {"endpoints": [1, 2], "label": "waist"}, {"endpoints": [2, 3]}, {"endpoints": [3, 0], "label": "hem"}]}
    },
    "stitches": [[{"panel": "front", "edge": 1}, {"panel": "back", "edge": 2}]]
  },
  "properties": {"units_in_meter": 100, "curvature_coords": "relative", "normalized_edge_loops": true}
})";

const std::string full = R"({
  "toile": 1,
  "units_in_meter": 1000,
  "fabric": "poplin",
  "panels": {
    "front": {
      "fabric": "denim", "grain": 45, "shrink": {"warp": 0.03}, "layer": 2,
      "holes": [{"vertices": [[100, 100], [150, 100], [100, 150]]},
                {"vertices": [[300, 300], [340, 300]],
                 "edges": [{"endpoints": [0, 1], "curvature": {"type": "circle", "params": [20, 0, 1]}},
                           {"endpoints": [1, 0], "curvature": {"type": "circle", "params": [20, 0, 1]}}]}],
      "lines": [{"vertices": [[50, 400], [450, 400]], "kind": "fold", "angle": 90},
                {"vertices": [[200, 200], [220, 200], [220, 220]], "kind": "cut", "closed": true}]
    },
    "back": {}
  },
  "pins": [{"panel": "back", "edge": 3, "from": 0.25, "to": 0.5}, {"label": "hem", "panel": "front"}],
  "elastics": [{"label": "waist", "ratio": 0.8, "stiffness": 40}],
  "seams": [
    {"a": {"panel": "front", "edge": 3, "from": 0.5, "to": 0}, "b": [{"panel": "back", "edge": 0, "to": 0.25}, {"panel": "back", "edge": 0, "from": 0.25, "to": 0.5}],
     "faces": "right_to_wrong"}
  ]
})";

Pattern base() {
    std::istringstream in(pattern_text);
    return read_pattern(in, "sample.json");
}

Pattern with(const std::string& companion) {
    Pattern pattern = base();
    std::istringstream in(companion);
    read_companion(in, "sample.toile.json", pattern);
    return pattern;
}

std::string refusal(const std::string& companion) {
    try {
        with(companion);
    } catch (const InputError& e) {
        return e.what();
    }
    return "read";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const auto at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), by);
}

} // namespace

TEST_CASE("a companion gives fabric, grain, shrinkage and layer") {
    const Pattern p = with(full);
    CHECK(p.fabric == "poplin");
    CHECK(p.panels[0].fabric == "denim");
    CHECK(p.panels[0].grain == Approx(EIGEN_PI / 4));
    CHECK(p.panels[0].shrink == Vec2(0, 0.03));
    CHECK(p.panels[0].layer == 2);
    CHECK(p.panels[1].shrink == Vec2(0, 0));
    CHECK(p.panels[1].fabric.empty());
    CHECK(p.panels[1].grain == Approx(EIGEN_PI / 2));
    CHECK(p.panels[1].layer == 0);
}

TEST_CASE("a companion gives holes and inner lines in its own unit") {
    const Panel front = with(full).panels[0];
    REQUIRE(front.holes.size() == 2);
    REQUIRE(front.holes[0].size() == 3);
    CHECK(front.holes[0][2].start.isApprox(Vec2(0.1, 0.15)));
    CHECK(front.holes[0][2].end.isApprox(Vec2(0.1, 0.1)));
    REQUIRE(front.holes[1].size() == 2);
    CHECK(std::get<Arc>(front.holes[1][0].curve).radius == Approx(0.02));
    REQUIRE(front.lines.size() == 2);
    CHECK(front.lines[0].kind == InnerLineKind::fold);
    CHECK(front.lines[0].edges.size() == 1);
    CHECK(front.lines[0].rest_angle == Approx(EIGEN_PI / 2));
    CHECK(front.lines[1].kind == InnerLineKind::cut);
    CHECK(front.lines[1].edges.size() == 3);
}

TEST_CASE("a companion gives pins and elastics by edge or by label") {
    const Pattern p = with(full);
    REQUIRE(p.pins.size() == 2);
    CHECK(p.pins[0].span.panel == 1);
    CHECK(p.pins[0].span.edge == 3);
    CHECK(p.pins[0].span.t0 == 0.25);
    CHECK(p.pins[0].span.t1 == 0.5);
    CHECK(p.pins[1].span.panel == 0);
    CHECK(p.pins[1].span.edge == 0);
    REQUIRE(p.elastics.size() == 2);
    CHECK(p.elastics[0].span.edge == 2);
    CHECK(p.elastics[1].span.panel == 1);
    CHECK(p.elastics[1].span.edge == 1);
    CHECK(p.elastics[1].ratio == 0.8);
    CHECK(p.elastics[1].stiffness == 40);
}

TEST_CASE("a companion gives seams between parts of edges") {
    const Pattern p = with(full);
    REQUIRE(p.seams.size() == 2);
    const Seam& s = p.seams[1];
    CHECK(s.faces == SeamFaces::right_to_wrong);
    CHECK(s.a[0].t0 == 0.5);
    CHECK(s.a[0].t1 == 0);
    REQUIRE(s.b.size() == 2);
    CHECK(s.b[1].t0 == 0.25);
    CHECK(s.name == "seam 1 (front.3[0.5..0] to back.0[0..0.25] + back.0[0.25..0.5])");
    CHECK(seam_lengths(p, s).ease == Approx(0).margin(1e-12));
    for (const Issue& i : check(p))
        CHECK_THAT(i.text, !Contains("seam 1"));
}

TEST_CASE("a companion beside the pattern is read with it") {
    const test::TempFolder folder;
    std::ofstream(folder / "shirt.json") << pattern_text;
    CHECK(read_pattern(folder / "shirt.json").fabric.empty());
    std::ofstream(folder / "shirt.toile.json") << R"({"toile": 1, "fabric": "silk"})";
    CHECK(read_pattern(folder / "shirt.json").fabric == "silk");
    std::ofstream(folder / "shirt.toile.json") << R"({"toile": 1, "fabrik": "silk"})";
    CHECK_THROWS_WITH(read_pattern(folder / "shirt.json"),
                      Contains("shirt.toile.json") && Contains("\"fabrik\""));
    CHECK(companion_path("a.b/shirt_specification.json") == "a.b/shirt_specification.toile.json");
}

TEST_CASE("what a companion gets wrong is named") {
    CHECK(refusal(full) == "read");
    CHECK(refusal("{}") == "sample.toile.json lacks the key \"toile\"");
    CHECK_THAT(refusal(replaced(full, "\"toile\": 1", "\"toile\": 2")),
               Contains("\"toile\" must be a whole number from 1 to 1, but is 2"));
    CHECK_THAT(refusal(replaced(full, "\"denim\"", "\"demin\"")),
               Contains("panel \"front\", \"fabric\" must be one of poplin, "));
    CHECK_THAT(refusal(replaced(full, "\"pins\"", "\"pinns\"")),
               Contains("unknown key \"pinns\"; known are: toile, "));
    CHECK_THAT(refusal(replaced(full, "\"layer\"", "\"lager\"")),
               Contains("panel \"front\" has the unknown key \"lager\""));
    CHECK_THAT(refusal(replaced(full, "\"back\": {}", "\"bakc\": {}")),
               Contains("\"bakc\", which is no panel of the pattern"));
    CHECK_THAT(
        refusal(replaced(full, "\"panel\": \"back\", \"edge\": 3", "\"panel\": \"left\", \"edge\": 3")),
        Contains("\"pins\", item 0, \"panel\" must be the name of a panel of the pattern, but is \"left\""));
    CHECK_THAT(refusal(replaced(full, "\"edge\": 3, \"from\": 0.25", "\"edge\": 4, \"from\": 0.25")),
               Contains("whole number from 0 to 3, but is 4"));
    CHECK_THAT(refusal(replaced(full, "\"from\": 0.25, \"to\": 0.5}, {\"label\"",
                                "\"from\": 0.5, \"to\": 0.5}, {\"label\"")),
               Contains("has no length"));
    CHECK_THAT(refusal(replaced(full, "\"label\": \"waist\"", "\"label\": \"waste\"")),
               Contains("must be the label of an edge, but is \"waste\""));
    CHECK_THAT(refusal(replaced(full, "\"ratio\": 0.8", "\"ratio\": 1.8")),
               Contains("\"ratio\" must be a number from 0.05 to 1, but is 1.8"));
    CHECK_THAT(refusal(replaced(full, "\"warp\": 0.03", "\"warp\": 3")),
               Contains("panel \"front\", \"shrink\", \"warp\" must be a number from -0.5 to 0.5, but is 3"));
    CHECK_THAT(refusal(replaced(full, "\"warp\": 0.03", "\"wrap\": 0.03")), Contains("unknown key \"wrap\""));
    CHECK_THAT(refusal(replaced(full, "\"kind\": \"fold\"", "\"kind\": \"crease\"")),
               Contains("must be \"fold\", \"pleat\" or \"cut\""));
    CHECK_THAT(refusal(replaced(full, "\"right_to_wrong\"", "\"wrong\"")),
               Contains("\"seams\", item 0, \"faces\" must be"));
    CHECK_THAT(refusal(replaced(full, "\"panel\": \"back\", \"edge\": 3, ", "")),
               Contains("lacks the key \"panel\" or \"label\""));
    CHECK_THAT(refusal("[]"), Contains("must be an object"));
    CHECK_THAT(refusal("{"), Contains("not valid JSON"));
}

TEST_CASE("a refused companion leaves the pattern as it was") {
    Pattern p = base();
    std::istringstream in(replaced(full, "\"right_to_wrong\"", "\"wrong\""));
    CHECK_THROWS_AS(read_companion(in, "x", p), InputError);
    CHECK(p.fabric.empty());
    CHECK(p.panels[0].holes.empty());
    CHECK(p.pins.empty());
}

TEST_CASE("every preset of a fabric may be named, and the schema knows them all") {
    const test::Schema schema("companion.schema.json");
    for (const Fabric& f : fabric_presets()) {
        const std::string text = replaced(full, "\"denim\"", "\"" + f.name + "\"");
        CHECK(with(text).panels[0].fabric == f.name);
        CHECK(schema.complaints(text).empty());
    }
}

TEST_CASE("the published schema accepts what is read and refuses what is refused") {
    const test::Schema schema("companion.schema.json");
    CHECK(schema.complaints(full).empty());
    CHECK(schema.complaints(R"({"toile": 1})").empty());
    const std::pair<const char*, const char*> wrong[] = {
        {"\"toile\": 1", "\"toile\": 2"},
        {"\"toile\": 1,", ""},
        {"\"fabric\": \"denim\"", "\"fabric\": \"demin\""},
        {"\"fabric\": \"poplin\"", "\"fabric\": 3"},
        {"\"pins\"", "\"pinns\""},
        {"\"layer\"", "\"lager\""},
        {"\"layer\": 2", "\"layer\": 2.5"},
        {"\"grain\": 45", "\"grain\": \"bias\""},
        {"\"from\": 0.25", "\"from\": -0.25"},
        {"\"warp\": 0.03", "\"warp\": 3"},
        {"\"warp\": 0.03", "\"wrap\": 0.03"},
        {"\"ratio\": 0.8", "\"ratio\": 1.8"},
        {"\"ratio\": 0.8,", ""},
        {"\"stiffness\": 40", "\"stiffness\": 0"},
        {"\"kind\": \"fold\"", "\"kind\": \"crease\""},
        {"\"kind\": \"fold\",", ""},
        {"\"right_to_wrong\"", "\"wrong\""},
        {"\"panel\": \"back\", \"edge\": 3, ", ""},
        {"[100, 100]", "[100]"},
        {"\"params\"", "\"values\""},
        {"\"units_in_meter\": 1000", "\"units_in_meter\": 0"},
    };
    for (const auto& [what, by] : wrong) {
        INFO(what << " -> " << by);
        const std::string text = replaced(full, what, by);
        CHECK_FALSE(schema.complaints(text).empty());
        CHECK(refusal(text) != "read");
    }
}
