// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_staged.h"

#include "io/read_avatar.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_data.h"

#include <catch2/catch.hpp>

#include <fstream>
#include <set>

using namespace toile;
using Catch::Matchers::Contains;

namespace {

/// Two squares of 1 m side by side in the flat, one behind the other in space. The second one's left side has
/// a node in the middle, sewn to the inside of the first one's right side.
const std::string sample = R"(# staged
v 0 0 0.2
v 1 0 0.2
v 1 1 0.2
v 0 1 0.2
v 0 0 -0.2
v 1 0 -0.2
v 1 1 -0.2
v 0 1 -0.2
v 0 0.5 -0.2
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vt 2 0
vt 3 0
vt 3 1
vt 2 1
vt 2 0.5
g front
f 1/1 2/2 3/3
f 1/1 3/3 4/4
g back
f 5/5 6/6 9/9
f 6/6 7/7 9/9
f 7/7 8/8 9/9
stitch 8 1 2 0.5
l 2 5
l 3 8
l 8 3
)";

StagedMesh staged(const std::string& text, const ReadStagedOptions& options = {}) {
    const test::TempFolder folder;
    std::ofstream(folder / "stage.obj") << text;
    return read_staged(folder / "stage.obj", options);
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const auto at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), by);
}

std::string refusal(const std::string& text) {
    try {
        staged(text);
    } catch (const InputError& e) {
        return e.what();
    }
    return "read";
}

/// The sample with its positions mapped.
template <class Map> std::string moved(Map&& map) {
    std::istringstream in(sample);
    std::ostringstream out;
    for (std::string line; std::getline(in, line);) {
        if (line.rfind("v ", 0) != 0) {
            out << line << '\n';
            continue;
        }
        std::istringstream numbers(line.substr(2));
        Vec3 p;
        numbers >> p.x() >> p.y() >> p.z();
        p = map(p);
        out << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    }
    return out.str();
}

} // namespace

TEST_CASE("a staged mesh becomes a garment with its positions, panels and stitches") {
    const StagedMesh s = staged(sample);
    const Garment& g = s.garment;
    CHECK(s.notes.empty());
    CHECK(g.panel_names == std::vector<std::string>{"front", "back"});
    CHECK(g.node_count == 9);
    CHECK(g.triangles.size() == 5);
    CHECK(s.positions[8] == Vec3(0, 0.5, -0.2));
    CHECK(g.panel_of_triangle == std::vector<int>{0, 0, 1, 1, 1});
    CHECK(g.rest.edges[0].col(0).isApprox(Vec2(1, 0)));
    CHECK(g.rest.angles.size() == std::size_t(g.edges.size()));

    REQUIRE(g.stitches.size() == 3); // the pair named from both sides counts once
    CHECK(g.stitches[0].a == 8);
    CHECK(g.stitches[0].b == std::array<int, 2>{1, 2});
    CHECK(g.stitches[0].r == 0.5);
    CHECK(g.stitches[0].length == Approx(0.5));
    CHECK(g.stitches[1].a == 1);
    CHECK(g.stitches[1].b == std::array<int, 2>{4, 4});
    CHECK(std::count(g.seam_edge.begin(), g.seam_edge.end(), true) == 3);
    CHECK(std::count(g.eased_triangle.begin(), g.eased_triangle.end(), true) == 0);

    REQUIRE(g.borders.size() == 2);
    CHECK(g.borders[0].panel == 0);
    CHECK(g.borders[0].vertices.size() == 5);
    CHECK(g.borders[0].vertices.front() == g.borders[0].vertices.back());
    CHECK(std::set<int>(g.borders[1].vertices.begin(), g.borders[1].vertices.end()) ==
          std::set<int>{4, 5, 6, 7, 8});
}

TEST_CASE("panels are the connected pieces of the flat, whatever the groups say") {
    const StagedMesh s = staged(replaced(sample, "g back\n", ""));
    CHECK(s.garment.panel_names == std::vector<std::string>{"front_1", "front_2"});
    const StagedMesh closed =
        staged(replaced(replaced(sample, "f 5/5 6/6 9/9", "f 2/5 6/6 9/9"), "l 2 5\n", ""));
    CHECK(closed.garment.panel_names.size() == 2); // one node with two vt is a closed seam
    CHECK(closed.garment.node_of_vertex[4] == 1);
}

TEST_CASE("a stitch that would join two corners of a triangle is left out, with a note") {
    const StagedMesh direct = staged(replaced(sample, "l 8 3\n", "l 6 7\n"));
    CHECK(direct.garment.stitches.size() == 3);
    REQUIRE(direct.notes.size() == 1);
    CHECK_THAT(direct.notes[0], Contains("nodes 5 and 6 was left out"));
    // By way of a node of the other panel.
    const StagedMesh chain = staged(replaced(sample, "l 8 3\n", "l 2 6\n"));
    CHECK(chain.garment.stitches.size() == 3);
    CHECK(chain.notes.size() == 1);
}

TEST_CASE("the unit of a staged mesh is told by its flat") {
    for (double per_metre : {10.0, 100.0, 1000.0}) {
        const StagedMesh s = staged(moved([&](const Vec3& p) -> Vec3 { return per_metre * p; }));
        CHECK(s.positions[6].isApprox(Vec3(1, 1, -0.2)));
        REQUIRE(s.notes.size() == 1);
        CHECK_THAT(s.notes[0], Contains("metres"));
    }
    CHECK_THAT(refusal(moved([](const Vec3& p) -> Vec3 { return 4.5 * p; })), Contains("fits no unit"));
    // Scaled texture coordinates with their scale beside them.
    std::string text = "# uv_metres 2\n" + moved([](const Vec3& p) -> Vec3 { return 2 * p; });
    CHECK(staged(text).garment.rest.edges[0].col(0).isApprox(Vec2(2, 0)));
}

TEST_CASE("a body tells which axis of a staged mesh is up") {
    TriMesh body;
    for (int i = 0; i < 20; ++i)
        body.points.push_back({0.5, 0.1 * i - 0.5, 0});
    ReadStagedOptions options;
    options.body = &body;
    CHECK(staged(sample, options).notes.empty());
    const StagedMesh s = staged(moved([](const Vec3& p) -> Vec3 { return {p.x(), -p.z(), p.y()}; }), options);
    CHECK(s.positions[8].isApprox(Vec3(0, 0.5, -0.2)));
    REQUIRE(s.notes.size() == 1);
    CHECK_THAT(s.notes[0], Contains("z up"));
}

TEST_CASE("an eased open seam marks the triangles on both of its sides") {
    // The second square's side is flat 1.2 m long, sewn to 1 m.
    const StagedMesh s = staged(replaced(sample, "vt 2 1\n", "vt 2 1.2\n"));
    const std::vector<bool>& eased = s.garment.eased_triangle;
    CHECK(eased[0]);
    CHECK(eased[4]);
}

TEST_CASE("what a staged mesh gets wrong is named") {
    CHECK(refusal(sample) == "read");
    CHECK_THAT(refusal(""), Contains("no triangles"));
    CHECK_THAT(refusal(replaced(sample, "f 1/1 2/2 3/3", "f 1 2 3")), Contains("without vt"));
    CHECK_THAT(refusal(replaced(sample, "f 1/1 2/2 3/3", "f 1/1 2/2 3/30")), Contains("line 21"));
    CHECK_THAT(refusal(replaced(sample, "vt 2 0.5", "vt 2.5 1")), Contains("no area in the flat"));
    CHECK_THAT(refusal(replaced(sample, "vt 2 0.5", "vt 3.5 0.5")),
               Contains("panel \"back\" is folded over"));
    CHECK_THAT(refusal(replaced(sample, "stitch 8 1 2 0.5", "stitch 8 1 2 1.5")), Contains("r 1.5"));
    CHECK_THAT(refusal(replaced(sample, "stitch 8 1 2 0.5", "stitch 8 1 99 0.5")), Contains("node 99"));
    CHECK_THAT(refusal(replaced(sample, "stitch 8 1 2 0.5", "stitch 8 1 8 0.5")),
               Contains("edge that ends in it"));
    CHECK_THAT(refusal(replaced(sample, "v 0 1 0.2", "v 0 nan 0.2")), Contains("line 5"));
    CHECK(staged(replaced(sample, "l 2 5", "l 2 2")).garment.stitches.size() == 2);
}

TEST_CASE("a dress staged by another program is read on its body") {
    const auto stage = test::test_data("cipc/dress_knife/stage.obj"),
               body = test::test_data("cipc/wm2_15k.obj");
    if (!stage || !body) return;
    ReadAvatarOptions repair;
    repair.repair = true;
    const ReadAvatar avatar = read_avatar(*body, repair);
    ReadStagedOptions options;
    options.body = &avatar.body;
    const StagedMesh s = read_staged(*stage, options);
    const Garment& g = s.garment;
    CHECK(g.node_count == 15656);
    CHECK(g.uv.size() == 15656);
    CHECK(g.triangles.size() == 29456);
    CHECK(g.panel_names.size() == 14);
    CHECK(g.stitches.size() > 820); // 24 name a pair again
    CHECK(g.stitches.size() <= 851);
    REQUIRE(s.notes.size() == 2);
    CHECK_THAT(s.notes[0], Contains("z up"));
    CHECK_THAT(s.notes[1], Contains("nodes 990 and 989 was left out")); // its own program collapses that triangle
    double area = 0;
    for (const Mat2& e : g.rest.edges)
        area += 0.5 * (e(0, 0) * e(1, 1) - e(0, 1) * e(1, 0));
    CHECK(area == Approx(0.68935).epsilon(1e-3));
    // Every border node of the waist and the shoulders is near its partner: the file's seams join neighbours.
    double worst = 0;
    for (const Stitch& t : g.stitches)
        worst = std::max(
            worst, (s.positions[t.a] - (1 - t.r) * s.positions[t.b[0]] - t.r * s.positions[t.b[1]]).norm());
    CHECK(worst < 0.3);
    for (const Vec3& p : s.positions) {
        CHECK(std::abs(p.x()) < 0.34);
        CHECK(p.y() > -0.21);
        CHECK(p.y() < 0.59);
    }
}
