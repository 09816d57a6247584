// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/garment_glb.h"
#include "io/garment_obj.h"
#include "io/read_garment.h"
#include "io/uv_layout.h"
#include "io/write_file.h"
#include "io/write_garment.h"
#include "tests/support/khronos.h"
#include "tests/support/skirt.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>

#include <filesystem>

using namespace toile;
using test::khronos_accepts;
using test::make_skirt;
using test::TempFolder;

namespace {

/// Positions with all 53 bits in use.
test::Skirt rough_skirt(bool closed = true) {
    test::Skirt s = make_skirt(8, 6, 0.15, 1.0, 0.6, closed);
    for (std::size_t i = 0; i < s.x.size(); ++i)
        s.x[i] *= 1 + 1e-3 / (3.0 + double(i));
    return s;
}

TriMesh tetrahedron() {
    return {{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

void require_same_cloth(const Garment& a, const Garment& b) {
    REQUIRE(a.triangles == b.triangles);
    REQUIRE(a.node_of_vertex == b.node_of_vertex);
    REQUIRE(a.panel_of_triangle == b.panel_of_triangle);
    REQUIRE(a.panel_of_vertex == b.panel_of_vertex);
    REQUIRE(a.panel_names == b.panel_names);
    REQUIRE(a.seam_edge == b.seam_edge);
    REQUIRE(a.edges.ends == b.edges.ends);
}

double largest_uv_difference(const Garment& a, const Garment& b) {
    double worst = 0;
    for (std::size_t v = 0; v < a.uv.size(); ++v)
        worst = std::max(worst, (a.uv[v] - b.uv[v]).norm());
    return worst;
}

double largest_difference(const Points& a, const Points& b) {
    REQUIRE(a.size() == b.size());
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        worst = std::max(worst, (a[i] - b[i]).norm());
    return worst;
}

} // namespace

TEST_CASE("an OBJ garment reads back with the same doubles, order, panels and seams") {
    const TempFolder folder;
    const auto s = rough_skirt();
    const std::string path = folder / "skirt.obj";
    write_garment(path, s.garment, s.x);
    CHECK(std::filesystem::exists(folder / "skirt.mtl"));
    const ReadGarment r = read_garment(path);
    require_same_cloth(s.garment, r.garment);
    CHECK(r.flat);
    CHECK(largest_difference(r.x, s.x) == 0);
    CHECK(largest_uv_difference(s.garment, r.garment) < 1e-15);
    CHECK(r.notes.empty());
    CHECK(r.avatar.triangles.empty());
}

TEST_CASE("a GLB garment reads back as the nearest floats in the same order") {
    const TempFolder folder;
    const auto s = rough_skirt();
    const std::string path = folder / "skirt.glb";
    write_garment(path, s.garment, s.x);
    const ReadGarment r = read_garment(path);
    require_same_cloth(s.garment, r.garment);
    CHECK(largest_difference(r.x, rounded_to_float(s.x)) == 0);
    CHECK(largest_difference(r.x, s.x) > 0);
    CHECK(largest_uv_difference(s.garment, r.garment) < 2e-7);
}

TEST_CASE("a GLB passes the Khronos validator, and a broken one does not") {
    const TempFolder folder;
    const auto s = rough_skirt();
    const TriMesh body = tetrahedron();
    WriteOptions options;
    options.avatar = &body;
    write_garment(folder / "good.glb", s.garment, s.x, options);
    const auto accepted = khronos_accepts(folder / "good.glb");
    if (!accepted) {
        WARN("skipped: the Khronos glTF validator is not installed in build/npm");
        return;
    }
    CHECK(*accepted);
    std::string bytes = read_file(folder / "good.glb", 1 << 24);
    bytes.replace(bytes.find("\"max\":[0"), 8, "\"max\":[9");
    write_file(folder / "bad.glb", bytes);
    CHECK_FALSE(*khronos_accepts(folder / "bad.glb"));
}

TEST_CASE("unit and up axis of an OBJ are undone by the reader") {
    const TempFolder folder;
    const auto s = rough_skirt();
    const std::string path = folder / "skirt.obj";
    WriteOptions options;
    options.metres_per_unit = 0.01;
    options.z_up = true;
    write_garment(path, s.garment, s.x, options);
    const std::string text = read_file(path, 1 << 20);
    double highest = 0;
    for (std::size_t at = text.find("\nv "); at != std::string::npos; at = text.find("\nv ", at + 1)) {
        double x, y, z;
        REQUIRE(std::sscanf(text.c_str() + at, "\nv %lf %lf %lf", &x, &y, &z) == 3);
        highest = std::max(highest, z);
    }
    CHECK(highest == Approx(100).epsilon(0.01));
    const ReadGarment r = read_garment(path);
    for (std::size_t i = 0; i < s.x.size(); ++i)
        CHECK((r.x[i] - s.x[i]).norm() < 1e-15);
}

TEST_CASE("the avatar travels as an object of its own and leaves the garment as it is") {
    const TempFolder folder;
    const auto s = rough_skirt();
    const TriMesh body = tetrahedron();
    WriteOptions options;
    options.avatar = &body;
    for (const char* name : {"a.obj", "a.glb"}) {
        write_garment(folder / name, s.garment, s.x, options);
        const ReadGarment r = read_garment(folder / name);
        require_same_cloth(s.garment, r.garment);
        CHECK(r.avatar.triangles == body.triangles);
        REQUIRE(r.avatar.points.size() == body.points.size());
        for (std::size_t i = 0; i < body.points.size(); ++i)
            CHECK((r.avatar.points[i] - body.points[i]).norm() < 1e-8);
    }
}

TEST_CASE("open seams travel as stitches") {
    const TempFolder folder;
    const auto s = rough_skirt(false);
    for (const char* name : {"open.obj", "open.glb"}) {
        write_garment(folder / name, s.garment, s.x);
        const Garment g = read_garment(folder / name).garment;
        require_same_cloth(s.garment, g);
        REQUIRE(g.stitches.size() == s.garment.stitches.size());
        for (std::size_t i = 0; i < g.stitches.size(); ++i) {
            CHECK(g.stitches[i].a == s.garment.stitches[i].a);
            CHECK(g.stitches[i].b == s.garment.stitches[i].b);
            CHECK(g.stitches[i].r == s.garment.stitches[i].r);
        }
    }
}

TEST_CASE("texture coordinates lie in the unit square, panels apart, in one scale") {
    const auto s = make_skirt(8, 6, 0.15, 1.0, 0.6);
    const UvLayout layout = lay_out_panels(s.garment);
    std::vector<Eigen::AlignedBox2d> boxes(2);
    for (std::size_t v = 0; v < s.garment.uv.size(); ++v) {
        const Vec2 t = texture_coordinates(s.garment, layout, int(v));
        CHECK((t.minCoeff() >= 0 && t.maxCoeff() <= 1));
        const auto p = std::size_t(s.garment.panel_of_vertex[v]);
        boxes[p].extend(t);
        CHECK((layout.scale * t + layout.origin[p] - s.garment.uv[v]).norm() < 1e-15);
    }
    CHECK_FALSE(boxes[0].intersects(boxes[1]));
    CHECK(layout.scale < 1.2);
}

TEST_CASE("panel names that OBJ cannot hold are made to fit") {
    const TempFolder folder;
    auto s = make_skirt(2, 2, 0.15, 1.0, 0.6);
    s.garment.panel_names = {"my panel", "my\tpanel"};
    write_garment(folder / "a.obj", s.garment, s.x);
    CHECK(read_garment(folder / "a.obj").garment.panel_names ==
          std::vector<std::string>{"my_panel", "my_panel_2"});
}

TEST_CASE("a staged mesh is read: stitches from 0, faces from 1, quads split, vt in metres") {
    const GarmentParts parts =
        parse_garment_obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 1e+000\nv 2 1 1\nv 1.1 0 1\n"
                          "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 3 0\nvt 3 1\nvt 2 0\n"
                          "g left\nf 1/1 2/2 3/3 4/4\ng right\nf -3/5 -2/6 -1/7\n"
                          "stitch 6 1 2 0.25\nl 6 2\n",
                          "staged");
    const ReadGarment r = assemble(parts, "staged");
    CHECK(r.garment.triangles.size() == 3);
    CHECK(r.garment.panel_names == std::vector<std::string>{"left", "right"});
    REQUIRE(r.garment.stitches.size() == 2);
    CHECK(r.garment.stitches[0].a == 6);
    CHECK(r.garment.stitches[0].b == std::array<int, 2>{1, 2});
    CHECK(r.garment.stitches[0].r == 0.25);
    CHECK(r.garment.stitches[1].a == 5);
    CHECK(r.garment.stitches[1].b[0] == 1);
    CHECK(r.garment.uv[6] == Vec2(2, 0));
}

TEST_CASE("a mesh of another tool: shared vt, an unknown scale, no vt at all") {
    const std::string points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    const ReadGarment scaled = assemble(
        parse_garment_obj(points + "vt 0 0\nvt .1 0\nvt .1 .1\nvt 0 .1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n", "a"),
        "a");
    CHECK(scaled.notes.size() == 1);
    CHECK(scaled.garment.uv[2].x() == Approx(1));
    const ReadGarment bare = assemble(parse_garment_obj(points + "f 1 2 3 4\n", "b"), "b");
    CHECK_FALSE(bare.flat);
    CHECK(bare.garment.triangles.size() == 2);
    CHECK(bare.x.size() == 4);
}

TEST_CASE("garment files that cannot be used are refused in a sentence with the place") {
    const auto refuse = [](const std::string& text) {
        try {
            assemble(parse_garment_obj(text, "bad.obj"), "bad.obj");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    CHECK(refuse("") == "bad.obj has no triangles of a garment");
    CHECK_THAT(refuse("v 0 0 nan\n"),
               Catch::Contains("line 1") && Catch::Contains("'nan' is not a finite number"));
    CHECK_THAT(refuse("v 0 0 1e999\n"), Catch::Contains("finite"));
    CHECK_THAT(refuse("v 0 0 0\nf 1 2 3\n"), Catch::Contains("line 2") && Catch::Contains("index 2"));
    CHECK_THAT(refuse("v 0 0 0\nv 1 0 0\nf 1 2 2\n"), Catch::Contains("uses node 1 twice"));
    CHECK_THAT(refuse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nstitch 0 1 7 0\n"),
               Catch::Contains("stitch names node 7"));
    CHECK_THAT(refuse("v 0 0 0\nf 1 1\n"), Catch::Contains("2 corners"));
}

TEST_CASE("a GLB that is cut short or lies about its sizes is refused") {
    const auto s = make_skirt(3, 3, 0.15, 1.0, 0.6);
    const std::string good = garment_glb(s.garment, s.x, {});
    CHECK_NOTHROW(assemble(parse_garment_glb(good, "a"), "a"));
    for (std::size_t size = 0; size < good.size(); size += 41)
        CHECK_THROWS_AS(assemble(parse_garment_glb(good.substr(0, size), "a"), "a"), InputError);
    // A flipped byte anywhere in the JSON either still reads or is refused, and never crashes.
    int refused = 0;
    for (std::size_t at = 20; at < 2000; ++at) {
        std::string bad = good;
        bad[at] = char(bad[at] ^ 0x05);
        try {
            assemble(parse_garment_glb(bad, "a"), "a");
        } catch (const InputError&) {
            ++refused;
        }
    }
    CHECK(refused > 500);
}

TEST_CASE("files are replaced whole or not at all") {
    const TempFolder folder;
    const std::string path = folder / "file.txt";
    write_file(path, "one");
    write_file(path, "two");
    CHECK(read_file(path, 100) == "two");
    CHECK_THROWS_AS(read_file(path, 2), InputError);
    CHECK_THROWS_AS(write_file(folder / "missing/file.txt", "x"), InputError);
    CHECK_THROWS_AS(check_writable(folder / "missing/file.txt"), InputError);
    CHECK_THROWS_AS(check_writable(folder.path()), InputError);
    CHECK_THROWS_AS(check_writable("/dev/null"), InputError);
    check_writable(folder / "new.txt");
    std::filesystem::create_symlink("file.txt", folder / "link.txt");
    write_file(folder / "link.txt", "three");
    CHECK(std::filesystem::is_symlink(folder / "link.txt"));
    CHECK(read_file(path, 100) == "three");
    const auto entries = std::distance(std::filesystem::directory_iterator(folder.path()), {});
    CHECK(entries == 2);
}

TEST_CASE("a garment file's ending says its format") {
    CHECK(garment_format("a.OBJ") == GarmentFormat::obj);
    CHECK(garment_format("x.y/a.glb") == GarmentFormat::glb);
    CHECK_THROWS_AS(garment_format("a.fbx"), InputError);
    CHECK_THROWS_AS(garment_format("a"), InputError);
}
