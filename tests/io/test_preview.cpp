// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/parallel.h"
#include "io/preview.h"
#include "io/write_file.h"
#include "tests/support/skirt.h"
#include "tests/support/temp_folder.h"

#include <catch2/catch.hpp>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>

#include <cmath>

using namespace toile;

namespace {

struct Picture {
    int width = 0, height = 0;
    std::vector<unsigned char> rgb;

    const unsigned char* at(int column, int row) const { return &rgb[std::size_t(3 * (row * width + column))]; }
    bool blue(int column, int row) const { return at(column, row)[2] > at(column, row)[0] + 25; }
};

Picture load(const std::string& path) {
    Picture p;
    unsigned char* data = stbi_load(path.c_str(), &p.width, &p.height, nullptr, 3);
    REQUIRE(data);
    p.rgb.assign(data, data + 3 * p.width * p.height);
    stbi_image_free(data);
    return p;
}

/// A tube around the y axis, as a body.
TriMesh tube(double radius, double low, double high) {
    const auto s = test::make_skirt(16, 1, radius, high, high - low);
    return {s.x, node_triangles(s.garment)};
}

} // namespace

TEST_CASE("a preview shows the cloth from front, back and side, the seams and the body") {
    const test::TempFolder folder;
    const auto skirt = test::make_skirt(24, 24, 0.2, 1.0, 0.4);
    write_preview(folder / "p.png", skirt.garment, skirt.x, tube(0.1, 0, 1.8), {240});
    const Picture p = load(folder / "p.png");
    CHECK(p.height == 240);
    const int view = (p.width - 2 * (240 / 60)) / 3; // the skirt is as deep as it is wide
    REQUIRE(view > 100);
    const int row = p.height / 2;
    for (int k = 0; k < 3; ++k) CHECK(p.blue(k * (view + 4) + view / 3, row));
    // Body above the skirt in the middle of each view, background in the corners.
    for (int k = 0; k < 3; ++k) {
        const int middle = k * (view + 4) + view / 2;
        CHECK(p.at(middle, 4)[0] > p.at(middle, 4)[2]);
        CHECK_FALSE(p.blue(k * (view + 4) + 2, 2));
        CHECK(p.at(k * (view + 4) + 2, 2)[0] > 200);
    }
    // The side view looks at the side seam: a dark line between two shades of blue.
    const int seam = 2 * (view + 4) + view / 2;
    int darkest = 255;
    for (int c = seam - 4; c <= seam + 4; ++c) darkest = std::min<int>(darkest, p.at(c, row)[2]);
    CHECK(darkest + 25 < p.at(seam - 8, row)[2]);
    CHECK(darkest + 25 < p.at(seam + 8, row)[2]);
}

TEST_CASE("a preview is the same for any number of threads, and needs no body") {
    const test::TempFolder folder;
    const auto skirt = test::make_skirt(12, 8, 0.2, 1.0, 0.4);
    set_threads(1);
    write_preview(folder / "1.png", skirt.garment, skirt.x, {}, {120});
    set_threads(2);
    write_preview(folder / "2.png", skirt.garment, skirt.x, {}, {120});
    set_threads(0);
    CHECK(read_file(folder / "1.png", 1 << 24) == read_file(folder / "2.png", 1 << 24));
}
