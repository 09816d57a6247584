// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/garment_glb.h"
#include "io/point_cache.h"
#include "io/read_garment.h"
#include "tests/support/khronos.h"
#include "tests/support/random.h"
#include "tests/support/read_cache.h"
#include "tests/support/skirt.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>

#include <csignal>
#include <filesystem>

#include <sys/resource.h>

using namespace toile;
using namespace toile::test;
using Catch::Contains;

namespace {

/// A skirt that is shaken, its last frame where it ends.
struct Shaken {
    Skirt skirt = make_skirt(8, 6, 0.15, 1.0, 0.6);
    std::vector<Points> frames;

    explicit Shaken(int count) {
        Random random(9);
        for (int k = 0; k < count; ++k) {
            frames.push_back(skirt.x);
            for (Vec3& p : frames.back()) p += random.vec3(0.05);
        }
        skirt.x = frames.back();
    }
};

std::vector<Points> as_floats(const std::vector<Points>& frames, const WriteOptions& options) {
    std::vector<Points> out = frames;
    for (Points& frame : out) {
        for (Vec3& p : frame) p = in_obj(p, options);
        frame = rounded_to_float(frame);
    }
    return out;
}

/// As long as it lives, files cannot grow beyond some bytes.
class FullDisk {
public:
    explicit FullDisk(rlim_t bytes) {
        getrlimit(RLIMIT_FSIZE, &before_);
        handler_ = std::signal(SIGXFSZ, SIG_IGN);
        const rlimit small{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &small);
    }
    ~FullDisk() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FullDisk(const FullDisk&) = delete;

private:
    rlimit before_;
    void (*handler_)(int);
};

} // namespace

TEST_CASE("point caches hold every frame in the order, unit and axes of the OBJ", "[animate]") {
    const TempFolder folder;
    const Shaken s(5);
    WriteOptions options;
    for (const bool other : {false, true}) {
        if (other) options.metres_per_unit = 0.01, options.z_up = true;
        write_garment(folder / "a.obj", s.skirt.garment, s.skirt.x, options);
        write_caches(folder / "a.obj", {s.frames, 24}, options);
        const ReadFrames pc2 = read_pc2(folder / "a.pc2", 24), mdd = read_mdd(folder / "a.mdd");
        REQUIRE(pc2.frames.size() == 5);
        CHECK(farthest(pc2.frames, as_floats(s.frames, options)) == 0);
        CHECK(farthest(mdd.frames, pc2.frames) == 0);
        for (std::size_t k = 0; k < 5; ++k) {
            CHECK(pc2.times[k] == double(k) / 24);
            CHECK(mdd.times[k] == double(float(double(k) / 24)));
        }
        // The lines `v` of the file, as they are written.
        std::istringstream obj(read_file(folder / "a.obj", 1 << 24));
        Points written;
        for (std::string line; std::getline(obj, line);)
            if (line.starts_with("v ")) {
                Vec3 p;
                REQUIRE(std::sscanf(line.c_str(), "v %lf %lf %lf", &p[0], &p[1], &p[2]) == 3);
                written.push_back(p);
            }
        CHECK(farthest({rounded_to_float(written)}, {pc2.frames.back()}) == 0);
    }
}

TEST_CASE("headers of point caches, byte for byte", "[animate]") {
    const TempFolder folder;
    const std::vector<Points> frames{{{1, -2, 0.5}}, {{0, 0, 0}}};
    write_pc2(folder / "a.pc2", {frames, 30});
    CHECK(read_file(folder / "a.pc2", 1000) == std::string("POINTCACHE2\0"
                                                           "\1\0\0\0\1\0\0\0\0\0\0\0\0\0\x80\x3f\2\0\0\0"
                                                           "\0\0\x80\x3f\0\0\0\xc0\0\0\0\x3f"
                                                           "\0\0\0\0\0\0\0\0\0\0\0\0",
                                                           56));
    write_mdd(folder / "a.mdd", {frames, 4});
    CHECK(read_file(folder / "a.mdd", 1000) == std::string("\0\0\0\2\0\0\0\1\0\0\0\0\x3e\x80\0\0"
                                                           "\x3f\x80\0\0\xc0\0\0\0\x3f\0\0\0"
                                                           "\0\0\0\0\0\0\0\0\0\0\0\0",
                                                           40));
}

TEST_CASE("a cache that the disk does not hold leaves what was there", "[animate]") {
    const TempFolder folder;
    const Shaken s(100);
    const std::string path = folder / "a.pc2";
    write_file(path, "before");
    {
        const FullDisk full(40000);
        CHECK_THROWS_WITH(write_pc2(path, {s.frames, 24}), Contains("cannot write") && Contains("File too large"));
    }
    CHECK(read_file(path, 100) == "before");
    CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
    write_pc2(path, {s.frames, 24});
    CHECK(std::filesystem::file_size(path) == 32 + 12 * 100 * s.skirt.x.size());
    CHECK_THROWS_AS(write_mdd(folder / "missing/a.mdd", {s.frames, 24}), InputError);
}

TEST_CASE("a GLB plays the frames by morph targets and ends as the garment", "[animate]") {
    const TempFolder folder;
    const Shaken s(7);
    const PointFrames motion{s.frames, 12.5};
    WriteOptions options;
    options.motion = &motion;
    const TriMesh body{{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
    options.avatar = &body;
    write_garment(folder / "a.glb", s.skirt.garment, s.skirt.x, options);
    const GlbFile file(folder / "a.glb");
    CHECK(file.gltf["animations"][0]["channels"].size() == 2); // panels; the body stands still
    const PlayedGlb keys = file.play(), between = file.play(true);
    REQUIRE(keys.vertices.frames.size() == 7);
    REQUIRE(keys.node.size() == s.skirt.garment.uv.size());
    for (std::size_t k = 0; k < 7; ++k) {
        CHECK(keys.vertices.times[k] == Approx(double(k) / 12.5));
        double off = 0, off_between = 0;
        for (std::size_t v = 0; v < keys.node.size(); ++v) {
            const std::size_t n = keys.node[v];
            off = std::max(off, (keys.vertices.frames[k][v] - s.frames[k][n]).norm());
            if (k + 1 < 7)
                off_between = std::max(off_between, (between.vertices.frames[k][v] - 0.5 * (s.frames[k][n] + s.frames[k + 1][n])).norm());
        }
        CHECK(off < 2e-7);
        CHECK(off_between < 2e-7);
    }
    // Whoever knows no animation sees the end, as without one.
    CHECK(farthest({read_garment(folder / "a.glb").x}, {rounded_to_float(s.skirt.x)}) == 0);
    const double still = double(garment_glb(s.skirt.garment, s.skirt.x, {}).size());
    const double size = double(std::filesystem::file_size(folder / "a.glb"));
    CHECK(size - still < 1.3 * animation_bytes(s.skirt.garment, 7));
    CHECK(size - still > 0.5 * animation_bytes(s.skirt.garment, 7));
    // One frame is no motion.
    const std::vector<Points> one{s.skirt.x};
    const PointFrames none{one, 24};
    options.motion = &none;
    CHECK_FALSE(GlbFile((write_garment(folder / "b.glb", s.skirt.garment, s.skirt.x, options), folder / "b.glb"))
                    .gltf.contains("animations"));
    const auto accepted = khronos_accepts(folder / "a.glb");
    if (!accepted) {
        WARN("the Khronos glTF validator is not installed in build/npm, and was not asked");
        return;
    }
    CHECK(*accepted);
    CHECK(*khronos_accepts(folder / "b.glb"));
}
