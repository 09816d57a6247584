// SPDX-License-Identifier: GPL-3.0-or-later

// Real patterns through reader, triangulation and seams.

#include "io/read_pattern.h"
#include "sewing/garment.h"
#include "tests/support/flat_quality.h"
#include "tests/support/test_data.h"

#include <catch2/catch.hpp>

#include <filesystem>

using namespace toile;
using namespace toile::test;

namespace {

std::vector<std::string> patterns() {
    std::vector<std::string> out;
    for (const char* folder : {"garmentcode", "garmentcode_2021"})
        if (const auto path = test_data(folder))
            for (const auto& file : std::filesystem::directory_iterator(*path))
                if (file.path().extension() == ".json") out.push_back(file.path().string());
    std::sort(out.begin(), out.end());
    return out;
}

/// Crosses itself: its collar runs past the armhole.
bool refused(const std::string& path) {
    return path.ends_with("rand_006_specification.json");
}

/// One of its panels narrows to a millimetre between two curves: no good triangle fits there.
bool pinched(const std::string& path) {
    return path.ends_with("rand_003_specification.json");
}

} // namespace

TEST_CASE("real patterns triangulate at the wanted size and close without a collapsed or non-manifold edge") {
    for (const std::string& path : patterns()) {
        CAPTURE(path);
        const Pattern pattern = read_pattern(path);
        TriangulateOptions options;
        options.levels = 3;
        if (refused(path)) {
            CHECK_THROWS_WITH(triangulate(pattern, options), Catch::Contains("crosses itself"));
            continue;
        }
        const FlatPattern flat = triangulate(pattern, options);
        for (const FlatLevel& level : flat.levels) {
            CAPTURE(level.edge_length);
            const FlatQuality q = measure(level, 2);
            CHECK(q.mean_ratio == Approx(1).epsilon(0.05));
            // At 40 mm some tips are half an edge wide.
            if (!pinched(path)) CHECK(q.smallest_angle > (level.edge_length > 0.03 ? 20 : 25));
            for (std::size_t s = 0; s < pattern.seams.size(); ++s)
                CHECK(!level.sewn[s].empty());
            const Garment closed = close_seams(sew(pattern, level));
            for (int e = 0; e < closed.edges.size(); ++e)
                CHECK(closed.edges.triangles_at(e) <= 2);
        }
    }
}
