// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_rest_mesh.h"

#include "io/companion.h"
#include "io/write_file.h"
#include "tests/support/obj_text.h"
#include "tests/support/schema.h"
#include "tests/support/surfaces.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>

#include <sstream>

using namespace toile;
using namespace toile::test;
using Catch::Matchers::Contains;

namespace {

std::string refusal(const std::string& file, const RestMeshOptions& options = {}) {
    try {
        read_rest_mesh(file, options);
    } catch (const InputError& error) {
        return error.what();
    }
    return "read";
}

} // namespace

TEST_CASE("edges of a rest mesh run along its borders as its triangles do, with the lengths of the mesh") {
    const TempFolder folder;
    const std::string file = folder / "tube.obj";
    write_file(file, obj_text(tube(0.1, 0.2, 12, 4))); // two borders, of 12 points each
    RestMeshOptions options;
    options.edges = {{1, 1}, {52, 58}, {58, 52}};
    const RestMesh rest = read_rest_mesh(file, options);
    REQUIRE(rest.edges.size() == 3);
    CHECK(rest.edges[0].size() == 13);
    CHECK(rest.edges[1].size() == 7);
    CHECK(rest.edges[2].size() == 7);
    CHECK(length_along(rest, 0) == Approx(24 * 0.1 * std::sin(EIGEN_PI / 12)).epsilon(1e-12));
    CHECK(fractions_along(rest, 1)[3] == Approx(0.5).epsilon(1e-12));
    CHECK((place_along(rest, 2, 0.5) - rest.mesh.points[rest.edges[2][3]]).norm() < 1e-12);
    for (const Triangle& t : rest.mesh.triangles) // the first segment of edge 0 is one of a triangle, in its direction
        for (int k = 0; k < 3; ++k) CHECK_FALSE((t[k] == rest.edges[0][1] && t[(k + 1) % 3] == rest.edges[0][0]));
    CHECK(read_rest_mesh(file).edges.empty());
}

TEST_CASE("a rest mesh that cannot be cloth, or whose edges are not on its border, is refused by file and element") {
    const TempFolder folder;
    const std::string file = folder / "cup.obj";
    const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 2 0\nv 3 2 0\nv 3 3 0\nv 0.5 0 1\nv 2 0 0\n";
    for (const auto& [faces, says] : std::vector<std::pair<std::string, std::string>>{
             {"f 1 2 3\nf 1 2 9\n", "the triangle of points 1, 2 and 9 has no area"},
             {"f 1 2 3\nf 5 6 7\n", "several pieces"},
             {"f 1 2 3\nf 1 2 4\n", "points 1 and 2 run along it in the same direction"},
             {"f 1 2 3\nf 2 1 4\nf 1 2 8\n", "the edge of points 1 and 2 has 3 triangles"},
             {"f 1 2 3\nf 3 5 6\n", "borders meet in point 3"}}) {
        write_file(file, square + faces);
        CHECK_THAT(refusal(file), Contains("cup.obj") && Contains(says));
    }
    CHECK_THAT(refusal(folder / "none.obj"), Contains("none.obj"));

    write_file(file, obj_text(ellipsoid(Vec3(1, 1, 1), 8, 6)));
    CHECK_THAT(refusal(file, {.edges = {{1, 2}}}), Contains("the mesh is closed"));
    write_file(file, obj_text(tube(0.1, 0.2, 12, 4)));
    CHECK_THAT(refusal(file, {.edges = {{1, 52}}}), Contains("edge 0 starts at point 1") && Contains("without passing point 52"));
    CHECK_THAT(refusal(file, {.edges = {{1, 20}}}), Contains("names point 20, which lies inside"));
    CHECK_THAT(refusal(file, {.edges = {{1, 99}}}), Contains("names point 99, which no triangle has"));
    CHECK_THAT(refusal(file, {.edges = {{1, 1}, {3, 5}}}), Contains("edge 1 takes the border from point 3 to"));
}

TEST_CASE("a companion brings in panels with a rest mesh, with edges that have its lengths") {
    const TempFolder folder;
    write_file(folder / "tube.obj", obj_text(tube(0.1, 0.2, 12, 4)));
    const std::string text = R"({"toile": 1, "panels": {"sleeve": {"rest_mesh": "tube.obj", "layer": 1, "fabric": "wool", "warp": [0, 1, 0],
        "edges": [{"from": 1, "to": 1, "label": "cuff"}], "translation": [0, 150, 10], "rotation": [0, 90, 0]}},
        "pins": [{"label": "cuff"}]})";
    write_file(folder / "a.toile.json", text);
    CHECK(Schema("companion.schema.json").complaints(text).empty());
    Pattern pattern;
    read_companion(folder / "a.toile.json", pattern);
    REQUIRE(pattern.panels.size() == 1);
    const Panel& panel = pattern.panels[0];
    REQUIRE(panel.rest);
    CHECK(panel.outline[0].label == "cuff");
    CHECK((panel.outline[0].end - panel.outline[0].start).norm() == Approx(length_along(*panel.rest, 0)));
    CHECK((panel.placement.translation - Vec3(0, 1.5, 0.1)).norm() < 1e-12);
    CHECK(pattern.pins.size() == 1);
    for (const auto& [key, by] : std::vector<std::pair<std::string, std::string>>{
             {"\"layer\": 1", "\"grain\": 45"}, {"\"from\": 1, ", ""}, {"[0, 150, 10]", "[0, 150]"}, {"\"tube.obj\"", "3"}}) {
        std::string wrong = text;
        wrong.replace(wrong.find(key), key.size(), by);
        CHECK_FALSE(Schema("companion.schema.json").complaints(wrong).empty());
        write_file(folder / "b.toile.json", wrong);
        Pattern other;
        CHECK_THROWS_AS(read_companion(folder / "b.toile.json", other), InputError);
    }
    CHECK_THROWS_WITH(read_companion(folder / "a.toile.json", pattern), Contains("panel \"sleeve\" has an outline in the pattern"));
}
