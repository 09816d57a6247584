// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_pattern.h"

#include "patterns/check.h"
#include "patterns/curve.h"
#include "tests/support/test_data.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

using namespace toile;
using Catch::Matchers::Contains;

namespace {

/// Two panels, every kind of edge, both kinds of stitch.
const std::string sample_text = R"({
  "pattern": {
    "panels": {
      "front": {
        "translation": [10, 20, 30], "rotation": [0, 0, 0], "label": "body",
        "vertices": [[0, 0], [50, 0], [50, 40], [0, 40]],
        "edges": [
          {"endpoints": [0, 1], "label": "lower_interface"},
          {"endpoints": [1, 2], "curvature": {"type": "quadratic", "params": [[0.5, 0.1]]}},
          {"endpoints": [2, 3], "curvature": {"type": "cubic", "params": [[0.25, -0.1], [0.75, -0.2]]}},
          {"endpoints": [3, 0], "curvature": {"type": "circle", "params": [25, 0, 1]}}
        ]
      },
      "back": {
        "translation": [0, 0, -30], "rotation": [0, 180, 0],
        "vertices": [[0, 0], [0, 40], [50, 40], [50, 0]],
        "edges": [{"endpoints": [0, 1]}, {"endpoints": [1, 2]}, {"endpoints": [2, 3]}, {"endpoints": [3, 0]}]
      }
    },
    "stitches": [
      [{"panel": "front", "edge": 1}, {"panel": "back", "edge": 0}],
      [{"panel": "front", "edge": 3}, {"panel": "back", "edge": 2}, "right_wrong"]
    ]
  },
  "properties": {"units_in_meter": 100, "curvature_coords": "relative", "normalize_panel_translation": false, "normalized_edge_loops": true}
})";

Pattern read(const std::string& text) {
    std::istringstream in(text);
    return read_pattern(in, "sample.json");
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
    const auto at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), with);
}

/// The sentence with which a text is refused; "read" when it is not.
std::string refusal(const std::string& text) {
    try {
        read(text);
    } catch (const InputError& e) {
        return e.what();
    }
    return "read";
}

std::string refusal(const std::string& what, const std::string& with) {
    return refusal(replaced(sample_text, what, with));
}

std::vector<std::string> files_in(const std::string& folder) {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".json") files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    return files;
}

Vec3 placed(const Panel& panel, const Vec2& p) {
    return panel.placement.rotation * Vec3(p.x(), p.y(), 0) + panel.placement.translation;
}

} // namespace

TEST_CASE("a specification is read in metres with its curves, labels and seams") {
    const Pattern p = read(sample_text);
    CHECK(p.name == "sample");
    REQUIRE(p.panels.size() == 2);
    const Panel& front = p.panels[0];
    CHECK(front.name == "front");
    CHECK(front.label == "body");
    CHECK(front.placement.translation.isApprox(Vec3(0.1, 0.2, 0.3)));
    CHECK(front.grain == Approx(EIGEN_PI / 2));
    REQUIRE(front.outline.size() == 4);
    CHECK(front.outline[0].label == "lower_interface");
    CHECK(front.outline[0].end.isApprox(Vec2(0.5, 0)));
    CHECK(std::holds_alternative<Straight>(front.outline[0].curve));
    // Upward edge: the control point with v > 0 lies left of travel.
    CHECK(std::get<Quadratic>(front.outline[1].curve).control.isApprox(Vec2(0.46, 0.2)));
    const Cubic cubic = std::get<Cubic>(front.outline[2].curve);
    CHECK(cubic.control0.isApprox(Vec2(0.375, 0.45)));
    CHECK(cubic.control1.isApprox(Vec2(0.125, 0.5)));
    const Arc arc = std::get<Arc>(front.outline[3].curve);
    CHECK(arc.radius == Approx(0.25));
    CHECK_FALSE(arc.large);
    CHECK(arc.right);
    CHECK(point_at(front.outline[3], 0.5).x() < 0); // downward travel, right is -x

    REQUIRE(p.seams.size() == 2);
    CHECK(p.seams[0].name == "seam 0 (front.1 to back.0)");
    CHECK(p.seams[0].faces == SeamFaces::right_to_right);
    CHECK(p.seams[0].a[0].t0 == 0);
    CHECK(p.seams[0].a[0].t1 == 1);
    CHECK(p.seams[0].b[0].t0 == 1); // the end of a meets the start of b
    CHECK(p.seams[0].b[0].t1 == 0);
    CHECK(p.seams[1].faces == SeamFaces::right_to_wrong);
    CHECK(p.seams[1].b[0].t0 == 0); // start meets start
    CHECK(p.seams[1].b[0].t1 == 1);
}

TEST_CASE("both windings are kept") {
    const Pattern p = read(sample_text);
    CHECK(signed_area(p.panels[0].outline) > 0);
    CHECK(signed_area(p.panels[1].outline) < 0);
}

TEST_CASE("rotations turn about x first, then y, then z") {
    const Pattern p = read(replaced(sample_text, "\"rotation\": [0, 180, 0]", "\"rotation\": [90, 90, 0]"));
    // About x: y becomes z. About y: z becomes x.
    CHECK(placed(p.panels[1], {0, 1}).isApprox(Vec3(1, 0, -0.3), 1e-12));
    CHECK(placed(p.panels[1], {1, 0}).isApprox(Vec3(0, 0, -1.3), 1e-12));
}

TEST_CASE("units scale lengths and radii but not relative control points") {
    const Pattern p = read(replaced(sample_text, "\"units_in_meter\": 100", "\"units_in_meter\": 1000"));
    CHECK(p.panels[0].outline[0].end.isApprox(Vec2(0.05, 0)));
    CHECK(p.panels[0].placement.translation.isApprox(Vec3(0.01, 0.02, 0.03)));
    CHECK(std::get<Arc>(p.panels[0].outline[3].curve).radius == Approx(0.025));
    CHECK(std::get<Quadratic>(p.panels[0].outline[1].curve).control.isApprox(Vec2(0.046, 0.02)));
}

TEST_CASE("the form of 2021 is read: control points, units, clockwise panels turned over") {
    const std::string text = R"({
      "pattern": {
        "panels": {
          "tri": {
            "translation": [30, 60, 90], "rotation": [0, 0, 0],
            "vertices": [[0, 0], [0, 150], [300, 0]],
            "edges": [{"endpoints": [0, 1], "curvature": [0.5, 0.2]}, {"endpoints": [1, 2]}, {"endpoints": [2, 0]}]
          }
        },
        "stitches": []
      },
      "properties": {"units_in_meter": 300, "curvature_coords": "relative", "normalize_panel_translation": false}
    })";
    const Pattern turned = read(text);
    const Panel& t = turned.panels[0];
    CHECK(signed_area(t.outline) > 0);
    CHECK(t.outline[1].end.isApprox(Vec2(-1, 0)));
    CHECK(std::get<Quadratic>(t.outline[0].curve).control.isApprox(Vec2(0.1, 0.25)));
    CHECK(t.placement.translation.isApprox(Vec3(-0.1, 0.2, 0.3)));
    // The cloth lies as drawn, but for the sign of its translation in x; its right side still faces -z.
    CHECK(placed(t, t.outline[1].end).isApprox(Vec3(1 - 0.1, 0.2, 0.3)));
    CHECK(t.placement.rotation.col(2).isApprox(Vec3(0, 0, -1)));

    const Pattern kept =
        read(replaced(text, "\"units_in_meter\"", "\"normalized_edge_loops\": true, \"units_in_meter\""));
    CHECK(signed_area(kept.panels[0].outline) < 0);
    CHECK(kept.panels[0].placement.translation.x() == Approx(0.1));
    CHECK(std::get<Quadratic>(kept.panels[0].outline[0].curve).control.isApprox(Vec2(-0.1, 0.25)));

    const Pattern absolute =
        read(replaced(replaced(text, "[0.5, 0.2]", "[-30, 75]"), "\"relative\"", "\"absolute\""));
    CHECK(std::get<Quadratic>(absolute.panels[0].outline[0].curve).control.isApprox(Vec2(0.1, 0.25)));
}

TEST_CASE("panels are centred when the file asks for it") {
    const Pattern p = read(replaced(sample_text, "\"normalize_panel_translation\": false",
                                    "\"normalize_panel_translation\": true"));
    CHECK(p.panels[0].outline[0].start.isApprox(Vec2(-0.25, -0.2)));
    CHECK(p.panels[0].placement.translation.isApprox(Vec3(0.35, 0.4, 0.3)));
}

TEST_CASE("what is no JSON is refused with the place") {
    CHECK(refusal("") == "sample.json is empty; JSON was expected");
    CHECK(refusal(" \n ") == "sample.json is empty; JSON was expected");
    CHECK_THAT(refusal("{\n\"pattern\": }"), Contains("sample.json is not valid JSON at line 2, column 12"));
    CHECK_THAT(refusal(sample_text.substr(0, 700)), Contains("is not valid JSON at line"));
    CHECK_THAT(refusal("[50, 40]", "[NaN, 40]"), Contains("is not valid JSON at line 6"));
    CHECK_THAT(refusal("[50, 40]", "[1e999, 40]"), Contains("is not valid JSON"));
    CHECK_THAT(refusal(std::string("\x00\xff\xfe garbage", 12)), Contains("is not valid JSON"));
    CHECK_THAT(refusal("[1, 2, 3]"), Contains("must be a GarmentCode specification"));
    CHECK_THAT(refusal("12"), Contains("must be a GarmentCode specification"));
}

TEST_CASE("JSON nested 200,000 deep is refused in a sentence") {
    for (const std::string open : {"[", "{\"a\":"}) {
        std::string deep;
        for (int i = 0; i < 200'000; ++i)
            deep += open;
        CHECK(refusal(deep) == "sample.json is nested more than 64 deep, which no pattern needs");
    }
}

TEST_CASE("keys given twice are refused") {
    CHECK_THAT(refusal("\"back\": {", "\"front\": {"), Contains("gives the key \"front\" twice"));
}

TEST_CASE("missing keys are named with their place") {
    CHECK(refusal("{}") == "sample.json lacks the key \"pattern\"");
    CHECK(refusal("\"properties\"", "\"other\"") == "sample.json lacks the key \"properties\"");
    CHECK_THAT(refusal("\"units_in_meter\"", "\"units\""), Contains("lacks the key \"units_in_meter\""));
    CHECK_THAT(refusal("\"stitches\"", "\"seams\""), Contains("lacks the key \"stitches\""));
    for (const char* key : {"\"translation\"", "\"rotation\"", "\"vertices\"", "\"edges\""})
        CHECK(refusal(key, "\"x\"") == "sample.json: panel \"front\" lacks the key " + std::string(key));
    CHECK(refusal("\"endpoints\"", "\"ends\"") ==
          "sample.json: panel \"front\", edge 0 lacks the key \"endpoints\"");
    CHECK_THAT(refusal("\"params\"", "\"values\""),
               Contains("panel \"front\", edge 1, \"curvature\" lacks the key \"params\""));
    CHECK_THAT(refusal("{\"panel\": \"front\", \"edge\": 1}", "{\"panel\": \"front\"}"),
               Contains("stitch 0, side 0 lacks the key \"edge\""));
}

TEST_CASE("wrong types and values are named with place, expectation and finding") {
    CHECK(refusal("[50, 40]", "[\"wide\", 40]") == "sample.json: panel \"front\", \"vertices\", vertex 2, "
                                                   "coordinate 0 must be a number, but is \"wide\"");
    CHECK_THAT(refusal("[50, 40]", "[50]"), Contains("vertex 2 must be an array of 2, but is an array of 1"));
    CHECK_THAT(refusal("[50, 40]", "[1e308, 40]"),
               Contains("vertex 2, coordinate 0 must be a length, but is 1e+308"));
    CHECK_THAT(refusal("[10, 20, 30]", "[10, 20]"), Contains("\"translation\" must be an array of 3"));
    CHECK_THAT(refusal("[0, 0, 0]", "[0, 0, true]"), Contains("\"rotation\", angle 2 must be a number"));
    CHECK_THAT(refusal("[0, 1]", "[0, 4]"),
               Contains("edge 0, \"endpoints\", number 1 must be the number of a vertex, 0 to 3, but is 4"));
    CHECK_THAT(refusal("[0, 1]", "[-1, 1]"), Contains("the number of a vertex"));
    CHECK_THAT(refusal("[0, 1]", "[0.5, 1]"), Contains("the number of a vertex"));
    CHECK_THAT(refusal("[0, 1]", "[0, 99999999999999999999]"), Contains("the number of a vertex"));
    CHECK_THAT(refusal("\"quadratic\"", "\"spline\""),
               Contains("\"type\" must be \"quadratic\", \"cubic\" or \"circle\", but is \"spline\""));
    CHECK_THAT(refusal("[[0.5, 0.1]]", "[[0.5, 0.1], [0.5, 0.1]]"),
               Contains("\"params\" must be an array of 1"));
    CHECK_THAT(refusal("[25, 0, 1]", "[-25, 0, 1]"), Contains("must be a radius above 0"));
    CHECK_THAT(refusal("[25, 0, 1]", "[25, 2, 1]"), Contains("must be true or false"));
    CHECK_THAT(refusal("\"units_in_meter\": 100", "\"units_in_meter\": 0"),
               Contains("\"units_in_meter\" must be a number from"));
    CHECK_THAT(refusal("\"relative\"", "\"polar\""), Contains("must be \"relative\" or \"absolute\""));
    CHECK_THAT(refusal("\"label\": \"body\"", "\"label\": 7"),
               Contains("\"label\" must be a string, but is 7"));
    CHECK_THAT(refusal("\"right_wrong\"", "\"wrong_right\""),
               Contains("stitch 1, third member must be \"right_wrong\""));
    CHECK_THAT(refusal("\"panel\": \"back\", \"edge\": 0", "\"panel\": \"bakc\", \"edge\": 0"),
               Contains("stitch 0, side 1, \"panel\" must be the name of a panel, but is \"bakc\""));
    CHECK_THAT(refusal("\"panel\": \"back\", \"edge\": 0", "\"panel\": \"back\", \"edge\": 4"),
               Contains("must be the number of an edge of panel \"back\", 0 to 3, but is 4"));
    CHECK_THAT(
        refusal(R"({"pattern": {"panels": {}, "stitches": []}, "properties": {"units_in_meter": 100}})"),
        Contains("has no panels"));
}

TEST_CASE("too many edges are refused by a stated limit") {
    std::ostringstream text;
    text
        << R"({"pattern": {"panels": {"p": {"translation": [0,0,0], "rotation": [0,0,0], "vertices": [[0,0],[1,0]], "edges": [)";
    for (int i = 0; i <= 100'000; ++i)
        text << (i ? "," : "") << R"({"endpoints":[0,1]})";
    text << R"(]}}, "stitches": []}, "properties": {"units_in_meter": 100}})";
    CHECK(refusal(text.str()) ==
          "sample.json: panel \"p\": the pattern has more than 100000 edges, the most that is read");
    CHECK(refusal(std::string((64u << 20) + 1, '[')) ==
          "sample.json is larger than 64 MB, the most that is read");
    std::string many = "[0";
    for (int i = 0; i < 5'000'000; ++i)
        many += ",0";
    CHECK_THAT(refusal(many + "]"), Contains("more than 5000000 values"));
}

TEST_CASE("a file that is not there, or no file, is refused") {
    CHECK_THROWS_WITH(read_pattern("/nowhere/tee.json"), Contains("/nowhere/tee.json"));
    CHECK_THROWS_WITH(read_pattern("/"), Contains("is a folder"));
}

TEST_CASE("real patterns read and are sound, but for the one that crosses itself") {
    const auto folder = test::test_data("garmentcode");
    if (!folder) return;
    const auto files = files_in(*folder);
    CHECK(files.size() == 32);
    int seams = 0, clockwise = 0;
    for (const std::string& file : files) {
        INFO(file);
        const Pattern p = read_pattern(file);
        seams += int(p.seams.size());
        for (const Panel& panel : p.panels)
            clockwise += signed_area(panel.outline) < 0;
        std::string errors;
        for (const Issue& i : check(p))
            if (i.severity == Severity::error) errors += i.text + "\n";
        if (file.find("rand_006") == std::string::npos) {
            CHECK(errors.empty());
        } else {
            CHECK_THAT(errors, Contains("panel \"left_ftorso\", edge 3 crosses edge 4"));
            CHECK_THAT(errors, Contains("panel \"right_ftorso\", edge 1 crosses edge 2"));
        }
    }
    CHECK(seams == 762);
    CHECK(clockwise == 122);
}

TEST_CASE("real patterns of 2021 read and are sound") {
    const auto folder = test::test_data("garmentcode_2021");
    if (!folder) return;
    const auto files = files_in(*folder);
    CHECK(files.size() == 5);
    for (const std::string& file : files) {
        INFO(file);
        CHECK_FALSE(has_error(check(read_pattern(file))));
    }
}

TEST_CASE("no real seam starts out more than 4 percent nearer in the direction that the file does not say") {
    for (const char* name : {"garmentcode", "garmentcode_2021"}) {
        const auto folder = test::test_data(name);
        if (!folder) return;
        for (const std::string& file : files_in(*folder)) {
            const Pattern p = read_pattern(file);
            for (const Seam& seam : p.seams) {
                const SeamSpan s = seam_span_at_start(p, seam);
                INFO(file << ": " << seam.name);
                CHECK(s.chosen <= 1.041 * s.other);
            }
        }
    }
}

TEST_CASE("the right side of real panels faces away from the body") {
    const auto folder = test::test_data("garmentcode");
    if (!folder) return;
    // Of the panels that stand upright before or behind the body, by their names.
    for (const char* file : {"tshirt", "pants", "pencil_skirt", "dress_pencil", "fitted_shirt_darts"}) {
        const Pattern p = read_pattern(*folder + "/" + file + "_specification.json");
        for (const Panel& panel : p.panels) {
            const Vec3 right = panel.placement.rotation.col(2) * (signed_area(panel.outline) > 0 ? 1 : -1);
            INFO(file << ": " << panel.name);
            CHECK(right.z() * panel.placement.translation.z() > 0);
        }
    }
}
