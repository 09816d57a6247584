// SPDX-License-Identifier: GPL-3.0-or-later
#include "patterns/check.h"
#include "patterns/curve.h"
#include "tests/support/polygon.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

using namespace toile;
using test::polygon;

namespace {

Panel square(const std::string& name, double size = 0.5) {
    Panel panel;
    panel.name = name;
    panel.outline = polygon({{0, 0}, {size, 0}, {size, size}, {0, size}});
    return panel;
}

/// Two squares one behind the other, sewn at the sides.
Pattern tube() {
    Pattern p;
    p.panels = {square("front"), square("back")};
    p.panels[0].placement.translation = {0, 0, 0.2};
    p.panels[1].placement.translation = {0, 0, -0.2};
    p.seams.push_back(
        {{{0, 1, 0, 1}}, {{1, 1, 0, 1}}, SeamFaces::right_to_right, "seam 0 (front.1 to back.1)"});
    p.seams.push_back(
        {{{0, 3, 0, 1}}, {{1, 3, 0, 1}}, SeamFaces::right_to_right, "seam 1 (front.3 to back.3)"});
    return p;
}

/// The issues of a severity, joined.
std::string issues(const Pattern& p, Severity severity = Severity::error, const CheckOptions& options = {}) {
    std::string all;
    for (const Issue& i : check(p, options))
        if (i.severity == severity) all += i.text + "\n";
    return all;
}

bool says(const std::string& text, std::initializer_list<const char*> words) {
    INFO(text);
    for (const char* w : words)
        CHECK_THAT(text, Catch::Matchers::Contains(w));
    return !text.empty();
}

} // namespace

TEST_CASE("a sound pattern has no issues") {
    CHECK(check(tube()).empty());
    CHECK_FALSE(has_error(check(tube())));
}

TEST_CASE("a pattern without panels is refused") {
    CHECK(says(issues(Pattern{}), {"no panels"}));
}

TEST_CASE("an open loop is named with both ends") {
    Pattern p = tube();
    p.panels[0].outline[2].end = {0.01, 0.5};
    CHECK(says(issues(p), {"panel \"front\"", "edge 2 ends at (1.0, 50.0) cm", "edge 3 starts", "open"}));
    CHECK(has_error(check(p)));
}

TEST_CASE("a panel that crosses itself names both edges and the place") {
    Pattern p = tube();
    p.panels[1].outline = polygon({{0, 0}, {0.5, 0.5}, {0.5, 0}, {0, 0.6}});
    CHECK(says(issues(p), {"panel \"back\"", "edge 0 crosses edge 2", "(27.3, 27.3) cm"}));
}

TEST_CASE("two curves that bulge through each other are found where their chords stay apart") {
    Pattern p = tube();
    Loop& o = p.panels[0].outline;
    o[0].curve = Quadratic{{0.25, 0.6}};
    CHECK(issues(p).empty());
    o[2].curve = Quadratic{{0.25, -0.2}};
    CHECK(says(issues(p), {"edge 0 crosses edge 2"}));
}

TEST_CASE("an edge that crosses itself is found") {
    Pattern p = tube();
    p.panels[0].outline[0].curve = Cubic{{0.9, -0.6}, {-0.4, -0.6}};
    CHECK(says(issues(p), {"edge 0 crosses itself"}));
}

TEST_CASE("an outline that touches itself is refused, shared corners and darts are not") {
    Pattern p = tube();
    p.seams.clear();
    p.panels[0].outline = polygon({{0, 0}, {0.5, 0}, {0.5, 0.5}, {0.25, 0}, {0, 0.5}});
    CHECK(says(issues(p), {"edge 0 touches edge 2"}));

    // A narrow dart: 2 mm wide, 12 cm deep.
    p.panels[0].outline =
        polygon({{0, 0}, {0.5, 0}, {0.5, 0.5}, {0.251, 0.5}, {0.25, 0.38}, {0.249, 0.5}, {0, 0.5}});
    p.seams = {{{{0, 3, 0, 1}}, {{0, 4, 1, 0}}, SeamFaces::right_to_right, "dart"}};
    CHECK(issues(p).empty());

    // A slit without width, out and back on one line, is no dart.
    p.panels[0].outline =
        polygon({{0, 0}, {0.5, 0}, {0.5, 0.5}, {0.25, 0.5}, {0.25, 0.38}, {0.25, 0.5}, {0, 0.5}});
    CHECK(says(issues(p), {"edge 3 touches edge 4"}));
}

TEST_CASE("curves that leave a corner along each other do not cross there") {
    Pattern p = tube();
    Loop& o =
        p.panels[0].outline; // both edges at the first corner start out near 48 degrees, 5 degrees apart
    const Vec2 a(std::cos(0.80), std::sin(0.80)), b(std::cos(0.88), std::sin(0.88));
    o[0].curve = Cubic{0.15 * a, {0.4, 0}};
    o[3].curve = Cubic{{0, 0.4}, 0.15 * b};
    CHECK(issues(p).empty());
}

TEST_CASE("degenerate edges are refused") {
    Pattern p = tube();
    p.panels[0].outline = polygon({{0, 0}, {0.5, 0}, {0.5, 0.5}, {0.49995, 0.5}, {0, 0.5}});
    CHECK(says(issues(p), {"panel \"front\"", "edge 2", "0.05 mm", "degenerate"}));
    p.panels[0].outline = polygon({{0, 0}, {0.5, 0}, {0.5, 0.5}, {0.5, 0.5}, {0, 0.5}});
    CHECK(says(issues(p), {"edge 2", "0 mm"}));
}

TEST_CASE("an arc needs a radius of at least half its chord") {
    Pattern p = tube();
    p.panels[0].outline[0].curve = Arc{0.2, false, true};
    CHECK(says(issues(p), {"edge 0", "radius 20 cm", "50 cm"}));
    p.panels[0].outline[0].curve = Arc{0.24999999, false, true}; // a rounding error
    CHECK(issues(p).empty());
}

TEST_CASE("a panel of two vertices encloses no area unless its edges are curved") {
    Pattern p = tube();
    p.seams.clear();
    p.panels[0].outline = polygon({{0, 0}, {0.5, 0}});
    CHECK(says(issues(p), {"Panel \"front\"", "no area"}));
    for (Edge& e : p.panels[0].outline)
        e.curve = Arc{0.25, false, true};
    CHECK(issues(p).empty());
}

TEST_CASE("coordinates that are no numbers are refused") {
    const double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()};
    for (double x : bad) {
        Pattern p = tube();
        p.panels[0].outline[1].end.x() = x;
        CHECK(says(issues(p), {"panel \"front\"", "edge 1", "not a finite number"}));
        p = tube();
        p.panels[0].outline[1].curve = Cubic{{0.1, x}, {0, 0}};
        CHECK(says(issues(p), {"edge 1", "not a finite number"}));
        p = tube();
        p.panels[1].placement.translation.z() = x;
        CHECK(says(issues(p), {"panel \"back\"", "not finite"}));
        p = tube();
        p.seams[0].a[0].t1 = x;
        CHECK(says(issues(p), {"Seam 0", "fractions from 0 to 1"}));
    }
}

TEST_CASE("senseless units are told by size and place") {
    Pattern p = tube();
    p.panels[0] = square("front", 293);
    CHECK(says(issues(p), {"Panel \"front\"", "293 m", "units"}));
    p.panels = {square("front", 0.005), square("back", 0.005)};
    CHECK(says(issues(p), {"5", "units"}));
    p = tube();
    p.panels[0].placement.translation = {0, 1500, 0};
    CHECK(says(issues(p), {"1500 m", "units"}));
}

TEST_CASE("seams that name nothing are refused") {
    Pattern p = tube();
    p.seams[0].a[0].panel = 7;
    CHECK(says(issues(p), {"Seam 0", "panel number 7", "does not exist"}));
    p = tube();
    p.seams[1].b[0].edge = 4;
    CHECK(says(issues(p), {"Seam 1", "edge 4", "panel \"back\"", "0 to 3"}));
    p = tube();
    p.seams[1].b.clear();
    CHECK(says(issues(p), {"Seam 1", "names no edge"}));
}

TEST_CASE("a seam to itself is refused, a dart is not") {
    Pattern p = tube();
    p.seams[0].b = p.seams[0].a;
    CHECK(says(issues(p), {"Seam 0", "to itself"}));
    std::swap(p.seams[0].b[0].t0, p.seams[0].b[0].t1);
    CHECK(says(issues(p), {"Seam 0", "to itself"}));
    // One edge folded in the middle, its halves sewn together.
    p.seams[0].a = {{0, 1, 0.5, 0}};
    p.seams[0].b = {{0, 1, 0.5, 1}};
    CHECK(issues(p).empty());
}

TEST_CASE("overlapping spans are refused, neighbouring ones are not") {
    Pattern p = tube();
    p.seams.push_back({{{0, 1, 0.9, 1}}, {{1, 0, 0, 0.1}}, SeamFaces::right_to_right, "seam 2 (x)"});
    CHECK(says(issues(p), {"Seam 0", "seam 2", "overlap", "edge 1 of panel \"front\""}));
    p.seams[0].a[0].t1 = 0.9;
    p.seams[0].b[0].t1 = 0.9;
    CHECK(issues(p).empty());
    // A long span behind a short one still overlaps a later one.
    p = tube();
    p.seams[0].name = "long";
    p.seams.push_back({{{0, 1, 0.1, 0.2}}, {{1, 0, 0, 0.1}}, SeamFaces::right_to_right, "early"});
    p.seams.push_back({{{0, 1, 0.7, 0.8}}, {{1, 0, 0.2, 0.3}}, SeamFaces::right_to_right, "late"});
    CHECK(says(issues(p), {"Long and early overlap", "Long and late overlap"}));
}

TEST_CASE("unequal lengths are a note, a warning or an error by their ease") {
    Pattern p = tube();
    const auto set = [&](double share) { p.seams[0].a[0].t1 = share; };
    set(0.95);
    CHECK(check(p).empty());
    set(0.8);
    CHECK(says(issues(p, Severity::note), {"Seam 0", "40 cm", "50 cm", "25 %"}));
    set(0.5);
    CHECK(says(issues(p, Severity::warning), {"Seam 0", "100 %"}));
    set(0.2);
    CHECK(says(issues(p), {"Seam 0", "10 cm", "50 cm", "400 %", "300 %"}));
    p.seams[0].b[0].t0 = 1 - 0.018; // 2 mm to 9 mm: nothing that cloth would mind
    p.seams[0].a[0].t1 = 0.004;
    CHECK(issues(p).empty());
    CHECK(says(issues(p, Severity::warning), {"Seam 0", "350 %"}));
    p.seams[0].a[0].t1 = 0.08;
    CHECK(says(issues(p), {"Seam 0", "344 %", "300 %"}));
}

TEST_CASE("seam lengths add up over the spans of a side") {
    Pattern p = tube();
    Seam seam{{{0, 0, 0, 1}, {0, 1, 0, 0.5}}, {{1, 0, 1, 0.2}}, SeamFaces::right_to_right, "s"};
    const SeamLengths l = seam_lengths(p, seam);
    CHECK(l.a == Approx(0.75));
    CHECK(l.b == Approx(0.4));
    CHECK(l.ease == Approx(0.75 / 0.4 - 1));
}

TEST_CASE("a seam whose other direction is much shorter is warned of and not refused") {
    Pattern p = tube();
    std::swap(p.seams[0].b[0].t0, p.seams[0].b[0].t1);
    CHECK(says(issues(p, Severity::warning), {"Seam 0", "twisted"}));
    CHECK(issues(p).empty());
}

TEST_CASE("a panel sewn to nothing is warned of") {
    Pattern p = tube();
    p.panels.push_back(square("pocket"));
    CHECK(says(issues(p, Severity::warning), {"Panel \"pocket\"", "sewn to nothing"}));
}

TEST_CASE("the number of edges is limited") {
    CheckOptions options;
    options.max_edges = 7;
    CHECK(says(issues(tube(), Severity::error, options), {"8 edges", "7"}));
}

TEST_CASE("holes and inner lines are checked like outlines") {
    Pattern p = tube();
    p.panels[0].holes = {polygon({{0.1, 0.1}, {0.1, 0.2}, {0.2, 0.2}})};
    p.panels[0].lines = {
        {{{{0, 0.25}, {0.5, 0.3}, Straight{}, {}}}, InnerLineKind::fold, 0}}; // ends on the outline
    CHECK(issues(p).empty());
    p.panels[0].lines[0].edges[0].end = {0.6, 0.3};
    CHECK(says(issues(p), {"edge 1 crosses inner line 0, edge 0"}));
    p = tube();
    p.panels[0].holes = {polygon({{0.4, 0.1}, {0.6, 0.1}, {0.4, 0.2}})};
    CHECK(says(issues(p), {"edge 1 crosses hole 0"}));
    p.panels[0].holes = {polygon({{0.7, 0.1}, {0.8, 0.1}, {0.7, 0.2}})};
    CHECK(says(issues(p), {"hole 0 lies outside"}));
    p.panels[0].holes = {polygon({{0.1, 0.1}, {0.3, 0.3}, {0.1, 0.3}}),
                         polygon({{0.2, 0.1}, {0.2, 0.4}, {0.3, 0.4}})};
    CHECK(says(issues(p), {"hole 0", "crosses hole 1"}));
    p.panels[0].holes = {{}};
    CHECK(says(issues(p), {"hole 0", "no edges"}));
}

TEST_CASE("elastics and pins must name parts of edges") {
    Pattern p = tube();
    p.elastics = {{{0, 2, 0, 1}, 0.7, 80}};
    p.pins = {{{1, 2, 0.2, 0.4}}};
    CHECK(issues(p).empty());
    p.elastics[0].ratio = 1.5;
    CHECK(says(issues(p), {"elastic", "edge 2", "panel \"front\"", "1.5"}));
    p.elastics[0] = {{0, 2, 0, 1}, 0.7, -1};
    CHECK(says(issues(p), {"elastic", "stiffness -1"}));
    p = tube();
    p.pins = {{{1, 9, 0.2, 0.4}}};
    CHECK(says(issues(p), {"pin", "edge 9"}));
}

TEST_CASE("a hopeless pattern gives a list of bounded length") {
    Pattern p;
    for (int i = 0; i < 500; ++i) {
        p.panels.push_back(square("p" + std::to_string(i)));
        p.panels.back().outline[0].end.x() += 0.1;
    }
    const auto list = check(p);
    CHECK(list.size() == 101);
    CHECK(says(list.back().text, {"more issues"}));
}

TEST_CASE("the largest outline accepted is checked in a moment") {
    const int n = 99'000;
    std::vector<Vec2> points;
    for (int i = 0; i < n; ++i) {
        const double a = 2 * EIGEN_PI * i / n, r = 5 + 0.001 * (i % 2);
        points.push_back({r * std::cos(a), r * std::sin(a)});
    }
    Pattern p;
    p.panels = {square("disc")};
    p.panels[0].outline = polygon(points);
    const auto begin = std::chrono::steady_clock::now();
    CHECK(issues(p).empty());
    CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < 10);
    std::swap(points[100], points[500]);
    p.panels[0].outline = polygon(points);
    CHECK(says(issues(p), {"crosses"}));
}
