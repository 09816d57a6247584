// SPDX-License-Identifier: GPL-3.0-or-later
// Starts made worse on purpose, as a table: bench_starts [CASE ...] [--edge 30mm] [--seconds 60]. Every panel of a
// real pattern is turned about its middle by up to 20 degrees and moved by up to 15 cm, and in every third case one
// panel is put exactly where another one is. Patterns, bodies and fabrics as for bench_drape.
#include "bench/manifest.h"
#include "draping/drape.h"
#include "src/drape_input.h"
#include "src/pipeline.h"
#include "src/quantity.h"
#include "tests/support/random.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

using namespace toile;

namespace {

constexpr int cases = 40;
constexpr double most_turned = 20 * EIGEN_PI / 180;
constexpr double most_moved = 0.15; // m

/// Garments that converge from where their files put the panels: tops, skirts, trousers, dresses.
const char* const garments[] = {"tshirt",       "pencil_skirt", "pants",       "dress_pencil",  "fitted_shirt_darts",
                                "circle_skirt", "shorts",       "shirt_mean",  "strapless_top", "godet_skirt",
                                "turtleneck",   "rand_009",     "tshirt_long_sleeve"};

Vec3 direction(test::Random& random) {
    const double y = random.in(-1, 1), turn = random.in(0, 2 * EIGEN_PI), r = std::sqrt(1 - y * y);
    return {r * std::cos(turn), y, r * std::sin(turn)};
}

Vec3 middle(const Panel& panel) {
    Vec2 sum = Vec2::Zero();
    for (const Edge& e : panel.outline) sum += e.start;
    sum /= double(panel.outline.size());
    return {sum.x(), sum.y(), 0};
}

void put(Panel& panel, const Mat3& rotation, const Vec3& middle_at) {
    panel.placement = {rotation, middle_at - rotation * middle(panel)};
}

Vec3 middle_in_space(const Panel& panel) {
    return panel.placement.rotation * middle(panel) + panel.placement.translation;
}

void worsen(Pattern& pattern, int seed, bool two_in_one_place) {
    test::Random random(seed);
    for (Panel& panel : pattern.panels) {
        const Vec3 axis = direction(random), way = direction(random);
        const double angle = random.in(0, most_turned), far = random.in(0, most_moved);
        put(panel, Eigen::AngleAxisd(angle, axis).toRotationMatrix() * panel.placement.rotation,
            middle_in_space(panel) + far * way);
    }
    const int count = int(pattern.panels.size());
    if (!two_in_one_place || count < 2) return;
    const int moved = random.below(count), other = (moved + 1 + random.below(count - 1)) % count;
    put(pattern.panels[moved], pattern.panels[other].placement.rotation, middle_in_space(pattern.panels[other]));
}

/// Whether it converged without a crossing.
bool drape_case(int number, const ManifestEntry& e, const std::string& data, double edge_length, double max_seconds) {
    const bool two_in_one_place = number % 3 == 2;
    std::vector<std::string> warnings;
    Pattern pattern = sound_pattern(pattern_file(data, e), warnings);
    worsen(pattern, number, two_in_one_place);
    const Body body = read_body(body_file(data, e), {}, false);
    const DrapeInput input = input_of(pattern, e.fabric, edge_length);
    DrapeOptions options;
    options.max_seconds = max_seconds;
    const auto start = std::chrono::steady_clock::now();
    const DrapeResult r =
        drape(input.staging, {body.mesh, smoothed_toward_core(body.mesh, 0.01)}, input.fabrics, options);
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const IntersectionCount n =
        count_intersections(node_triangles(r.garment), r.state.positions, body.mesh, r.garment.stitches);
    std::string iterations;
    for (const LevelReport& level : r.levels)
        iterations += (iterations.empty() ? "" : " / ") + std::to_string(level.iterations);
    std::printf("| %d | %s | %s | %s | %.1f | %s | %d, %d | %s |\n", number, e.name.c_str(),
                two_in_one_place ? "two in one place" : "turned, moved", to_string(r.status), wall,
                iterations.c_str(), n.cloth_avatar, n.cloth_cloth, r.where.c_str());
    std::fflush(stdout);
    return r.status == DrapeStatus::converged && n.cloth_avatar + n.cloth_cloth == 0;
}

} // namespace

int main(int count, char** words) {
    const char* data = std::getenv("TOILE_TEST_DATA");
    double edge_length = 0.03, max_seconds = 60;
    std::vector<int> chosen;
    for (int i = 1; i < count; ++i) {
        const std::string word = words[i];
        if (word == "--edge" && i + 1 < count)
            edge_length = parse_length(words[++i]);
        else if (word == "--seconds" && i + 1 < count)
            max_seconds = std::atof(words[++i]);
        else
            chosen.push_back(std::atoi(words[i]));
    }
    if (!data) {
        std::fprintf(stderr, "usage: TOILE_TEST_DATA=folder bench_starts [CASE ...] [--edge 30mm] [--seconds 60]\n");
        return 1;
    }
    if (chosen.empty())
        for (int i = 0; i < cases; ++i) chosen.push_back(i);
    const std::vector<ManifestEntry> manifest = read_manifest(data);
    std::printf("| case | garment | start | status | s | iterations by level | crossings | where |\n"
                "|---|---|---|---|---|---|---|---|\n");
    int converged = 0;
    for (int i : chosen) {
        const std::string name = garments[i % std::size(garments)];
        const auto e = std::find_if(manifest.begin(), manifest.end(), [&](const auto& m) { return m.name == name; });
        if (e != manifest.end()) converged += drape_case(i, *e, data, edge_length, max_seconds);
    }
    std::printf("\n%d of %d converge without a crossing.\n", converged, int(chosen.size()));
}
