// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/flat_svg.h"

#include "io/read_pattern.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"
#include "tests/support/polygon.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>

using namespace toile;
using test::polygon;
using Catch::Matchers::Contains;

namespace {

Panel box(const std::string& name, double width, double height) {
    Panel panel;
    panel.name = name;
    panel.outline = polygon({{-1, 2}, {-1 + width, 2}, {-1 + width, 2 + height}, {-1, 2 + height}});
    return panel;
}

/// Tags that are opened are closed, in order; attributes are quoted.
void check_well_formed(const std::string& svg) {
    std::vector<std::string> open;
    static const std::regex tag("<(/?)([a-z]+)((?: [a-zA-Z0-9:-]+=\"[^\"<]*\")*)(/?)>");
    std::size_t at = svg.find("?>") + 2;
    while ((at = svg.find('<', at)) != std::string::npos) {
        const std::size_t end = svg.find('>', at);
        REQUIRE(end != std::string::npos);
        const std::string text = svg.substr(at, end - at + 1);
        std::smatch m;
        INFO(text);
        REQUIRE(std::regex_match(text, m, tag));
        if (m[1].length()) {
            REQUIRE(!open.empty());
            CHECK(open.back() == m[2]);
            open.pop_back();
        } else if (!m[4].length()) {
            open.push_back(m[2]);
        }
        at = end;
    }
    CHECK(open.empty());
}

std::vector<std::string> matches(const std::string& svg, const std::string& expression) {
    const std::regex pattern(expression);
    std::vector<std::string> found;
    for (std::sregex_iterator i(svg.begin(), svg.end(), pattern), end; i != end; ++i)
        found.push_back((*i)[1]);
    return found;
}

struct Box {
    double left, right, top, bottom;
};

std::vector<Box> panel_boxes(const std::string& svg) {
    std::vector<Box> boxes;
    for (std::string d : matches(svg, "class=\"panel\" d=\"([^\"]*)\"")) {
        std::replace_if(
            d.begin(), d.end(), [](char c) { return c == 'M' || c == 'L' || c == 'Z'; }, ' ');
        std::istringstream in(d);
        Box b{1e9, -1e9, 1e9, -1e9};
        for (double x, y; in >> x >> y;)
            b = {std::min(b.left, x), std::max(b.right, x), std::min(b.top, y), std::max(b.bottom, y)};
        boxes.push_back(b);
    }
    return boxes;
}

} // namespace

TEST_CASE("panels lie beside each other at full size in millimetres") {
    Pattern p;
    for (int i = 0; i < 9; ++i)
        p.panels.push_back(box("p" + std::to_string(i), 0.1 + 0.07 * i, 0.9 - 0.1 * ((i * 5) % 9)));
    const std::string svg = flat_svg(p);
    check_well_formed(svg);
    const std::vector<Box> boxes = panel_boxes(svg);
    REQUIRE(boxes.size() == 9);
    const auto size = matches(svg, "viewBox=\"0 0 ([0-9. ]*)\"");
    REQUIRE(size.size() == 1);
    std::istringstream in(size[0]);
    double width = 0, height = 0;
    in >> width >> height;
    CHECK_THAT(svg, Contains("width=\"" + matches(svg, "width=\"([0-9.]*)mm\"")[0] + "mm\""));
    for (int i = 0; i < 9; ++i) {
        CHECK(boxes[i].right - boxes[i].left == Approx(1000 * (0.1 + 0.07 * i)).margin(0.03));
        CHECK(boxes[i].bottom - boxes[i].top == Approx(1000 * (0.9 - 0.1 * ((i * 5) % 9))).margin(0.03));
        CHECK(boxes[i].left > 0);
        CHECK(boxes[i].top > 0);
        CHECK(boxes[i].right < width);
        CHECK(boxes[i].bottom < height);
        for (int k = 0; k < i; ++k)
            CHECK((boxes[i].left > boxes[k].right || boxes[k].left > boxes[i].right ||
                   boxes[i].top > boxes[k].bottom || boxes[k].top > boxes[i].bottom));
    }
}

TEST_CASE("outlines are drawn with their real curves, y upward") {
    Pattern p;
    Panel panel;
    panel.name = "a";
    panel.outline = {{{0, 0}, {0.4, 0}, Quadratic{{0.2, 0.1}}, {}},
                     {{0.4, 0}, {0.4, 0.4}, Arc{0.25, false, true}, {}},
                     {{0.4, 0.4}, {0, 0.4}, Cubic{{0.3, 0.3}, {0.1, 0.3}}, {}},
                     {{0, 0.4}, {0, 0}, Arc{0.3, false, false}, {}}};
    p.panels = {panel};
    const std::string d = matches(flat_svg(p), "class=\"panel\" d=\"([^\"]*)\"").at(0);
    static const std::regex form(
        R"(M([0-9.]+) ([0-9.]+) Q[0-9. ]+ C?[0-9. ]*A250 250 0 0 0 [0-9.]+ [0-9.]+ C[0-9. ]+ A300 300 0 0 1 [0-9. ]+ Z)");
    std::smatch m;
    INFO(d);
    REQUIRE(std::regex_match(d, m, form));
    // The control point of the first edge lies 200 mm to the right and 100 mm above its start.
    const double x = std::stod(m[1]), y = std::stod(m[2]);
    const auto number = [](double v) {
        std::ostringstream out;
        out << std::round(100 * v) / 100;
        return out.str();
    };
    CHECK_THAT(d, Contains("Q" + number(x + 200) + " " + number(y - 100)));
}

TEST_CASE("both sides of every seam carry its number") {
    Pattern p;
    p.panels = {box("front", 0.5, 0.6), box("back", 0.5, 0.6)};
    p.seams = {{{{0, 1, 0, 1}}, {{1, 1, 0, 1}}, SeamFaces::right_to_right, "seam 0"},
               {{{0, 3, 0, 0.5}, {0, 3, 0.5, 1}}, {{1, 3, 0, 1}}, SeamFaces::right_to_right, "seam 1"}};
    const std::string svg = flat_svg(p);
    check_well_formed(svg);
    std::map<std::string, int> count;
    for (const std::string& n : matches(svg, "class=\"seam\"[^>]*>([0-9]+)</text>"))
        ++count[n];
    CHECK(count == std::map<std::string, int>{{"0", 2}, {"1", 2}});
}

TEST_CASE("names, labels, grain, holes, lines, elastics and pins are drawn") {
    Pattern p;
    p.name = "a <b> & \"c\"";
    p.panels = {box("front", 0.5, 0.6)};
    p.panels[0].fabric = "denim";
    p.panels[0].layer = 3;
    p.panels[0].outline[2].label = "upper";
    p.panels[0].holes = {polygon({{-0.9, 2.1}, {-0.8, 2.1}, {-0.9, 2.2}})};
    p.panels[0].lines = {{polygon({{-0.7, 2.3}, {-0.6, 2.3}}), InnerLineKind::cut, 0},
                         {polygon({{-0.7, 2.4}, {-0.6, 2.4}}), InnerLineKind::fold, 0}};
    p.elastics = {{{0, 2, 0, 1}, 0.75, 50}};
    p.pins = {{{0, 0, 0.5, 0.7}}};
    const std::string svg = flat_svg(p);
    check_well_formed(svg);
    for (const char* word : {">front<", ">denim<", ">layer 3<", ">upper<", ">elastic 0.75<", ">pinned<",
                             ">10 cm<", "a &lt;b&gt; &amp; &quot;c&quot;", "class=\"grain\""})
        CHECK_THAT(svg, Contains(word));
    CHECK(matches(svg, "class=\"panel\" d=\"([^\"]*)\"").at(0).find(" M") != std::string::npos); // the hole
    CHECK_THAT(svg, !Contains("wrong side up"));
    std::reverse(p.panels[0].outline.begin(), p.panels[0].outline.end());
    for (Edge& e : p.panels[0].outline)
        std::swap(e.start, e.end);
    CHECK_THAT(flat_svg(p), Contains("wrong side up"));
}

TEST_CASE("the picture is written, and a place that cannot be written is refused") {
    Pattern p;
    p.panels = {box("front", 0.5, 0.6)};
    const test::TempFolder folder;
    write_flat_svg(folder / "flat.svg", p);
    std::ifstream in(folder / "flat.svg");
    std::ostringstream text;
    text << in.rdbuf();
    CHECK(text.str() == flat_svg(p));
    CHECK_THROWS_AS(write_flat_svg(folder / "nowhere/flat.svg", p), InputError);
}

TEST_CASE("real patterns are drawn with every panel and seam") {
    for (const char* file :
         {"garmentcode/jumpsuit_specification.json", "garmentcode/rand_004_specification.json",
          "garmentcode/rand_006_specification.json", "garmentcode_2021/tee_hood.json"}) {
        const auto path = test::test_data(file);
        if (!path) return;
        const Pattern p = read_pattern(*path);
        const std::string svg = flat_svg(p);
        INFO(file);
        check_well_formed(svg);
        CHECK(matches(svg, "(class=\"panel\")").size() == p.panels.size());
        CHECK(matches(svg, "(class=\"seam\")").size() == 2 * p.seams.size());
        CHECK(svg.find("nan") == std::string::npos);
        CHECK(svg.find("inf") == std::string::npos);
    }
}
