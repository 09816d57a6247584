// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_sequence.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>

#include <fstream>

using namespace toile;
using namespace toile::test;
using Catch::Contains;

namespace {

/// A box as tall as a person, in centimetres and z up, its top pushed aside by `lean` cm; of quads but for its top.
void write_box(const std::string& path, double lean, bool turned_face = false, bool more = false) {
    std::ofstream out(path);
    out << "v 9 9 9\n"; // no face names it
    for (int i = 0; i < 8; ++i)
        out << "v " << (i & 1 ? 20 : -20) + (i & 4 ? lean : 0) << ' ' << (i & 2 ? 15 : -15) << ' ' << (i & 4 ? 170 : 0) << '\n';
    if (more) out << "v 0 0 80\n";
    out << "f 2 4 5 3\nf 6 7 9 8\nf 2 3 7 6\nf 4 8 9 5\nf 2 6 8 4\n";
    out << (turned_face ? "f 5 9 7 3\n" : "f 3 5 9 7\n");
}

} // namespace

TEST_CASE("a sequence has the points of every frame in the order, unit and axes of the first", "[sequence]") {
    const TempFolder folder;
    std::vector<std::string> files;
    for (const int lean : {0, 3, 60}) { // far enough that the shorter diagonals of quads change
        files.push_back(folder / ("walk_" + std::to_string(101 + files.size()) + ".obj"));
        write_box(files.back(), lean);
    }
    const ReadSequence s = read_sequence(files);
    REQUIRE(s.frames.size() == 2);
    REQUIRE(s.body.points.size() == 8);
    for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t v = 0; v < 8; ++v) {
            const Vec3& still = s.body.points[v];
            const double lean = still.y() > 1 ? (k == 0 ? 0.03 : 0.6) : 0;
            CHECK((s.frames[k][v] - still - Vec3(lean, 0, 0)).norm() < 1e-12);
        }
    CHECK(frame_numbers(files) == std::vector<int>{101, 102, 103});
    CHECK(sequence_files({folder.path()}) == files);
    CHECK(sequence_files({folder / "walk_%d.obj"}) == files);
    CHECK(sequence_files({folder / "walk_%03d.obj"}) == files);
    CHECK(sequence_files(files) == files);
    CHECK(frame_numbers({"a.obj", "b.obj"}) == std::vector<int>{0, 1});
    CHECK(frame_numbers({"a2.obj", "a1.obj"}) == std::vector<int>{0, 1});
}

TEST_CASE("frames of another topology are refused by name and number", "[sequence]") {
    const TempFolder folder;
    write_box(folder / "a.0001.obj", 0);
    write_box(folder / "a.0002.obj", 1, true);
    write_box(folder / "a.0003.obj", 1, false, true);
    CHECK_THROWS_WITH(read_sequence({folder / "a.0001.obj", folder / "a.0002.obj"}),
                      Contains("a.0002.obj: frame 2 is another mesh than the first: face 6 has other corners"));
    CHECK_THROWS_WITH(read_sequence({folder / "a.0001.obj", folder / "a.0003.obj"}),
                      Contains("frame 3 is another mesh than the first: 10 points instead of 9"));
    CHECK_THROWS_WITH(read_sequence({folder / "a.0001.obj", folder / "b.obj"}), Contains("there is no such file"));
}

TEST_CASE("names that do not tell the order of frames are refused", "[sequence]") {
    const TempFolder folder;
    CHECK_THROWS_WITH(sequence_files({folder.path()}), Contains("no .obj or .ply file"));
    CHECK_THROWS_WITH(sequence_files({folder / "a.%04d.obj"}), Contains("no file has such a name"));
    CHECK_THROWS_WITH(sequence_files({folder / "none/a.%04d.obj"}), Contains("cannot be read"));
    write_box(folder / "a.0001.obj", 0);
    write_box(folder / "a.0003.obj", 0);
    CHECK_THROWS_WITH(sequence_files({folder / "a.%04d.obj"}), Contains("frame 2 is missing"));
    write_box(folder / "b.3.obj", 0);
    CHECK_THROWS_WITH(sequence_files({folder.path()}), Contains("are both frame 3"));
    write_box(folder / "body.obj", 0);
    CHECK_THROWS_WITH(sequence_files({folder.path()}), Contains("body.obj: the name does not end in the number"));
}
