// SPDX-License-Identifier: GPL-3.0-or-later
// Random panels flung at a body: whether anything crosses, on the way and at the end.
//   bench_flung [number of scenes [first seed [iterations]]]
// One scene in four is on a real body when TOILE_TEST_DATA is set. Exits with 1 when something crosses. Every scene has a
// line on stderr, with its seed.
#include "io/read_avatar.h"
#include "tests/support/flung_scene.h"

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>

using namespace toile;

namespace {

struct Row {
    const char* name;
    TriMesh body;
    int scenes = 0, at_rest = 0, crossing_flight = 0, crossings = 0, inside = 0;
    double clearance = std::numeric_limits<double>::infinity(), seconds = 0;
    long nodes = 0;
};

void run(Row& row, std::uint64_t seed, int iterations) {
    const std::clock_t start = std::clock();
    test::FlungScene scene = test::flung_scene(row.body, seed);
    const test::FlungEnd end = test::fling(scene, iterations);
    const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
    ++row.scenes;
    row.at_rest += end.at_rest;
    row.crossing_flight += end.crossing_flight;
    row.crossings += end.crossings;
    row.inside += end.nodes_inside;
    row.clearance = std::min(row.clearance, end.clearance);
    row.seconds += seconds;
    row.nodes += scene.garment.node_count;
    std::fprintf(stderr,
                 "seed %llu on %s: %zu panels, %d nodes, %s after %d, crossings %d on the way, %d at the end, %d nodes "
                 "inside, clearance %.4f mm, %.1f s\n",
                 static_cast<unsigned long long>(seed), row.name, scene.fabrics.size(), scene.garment.node_count,
                 end.at_rest ? "at rest" : "not at rest", end.iterations, end.crossing_flight, end.crossings,
                 end.nodes_inside, 1e3 * end.clearance, seconds);
}

} // namespace

int main(int argc, char** argv) {
    const int count = argc > 1 ? std::atoi(argv[1]) : 200;
    const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
    const int iterations = argc > 3 ? std::atoi(argv[3]) : 400;
    std::vector<Row> rows = {{"sphere", test::sphere(0.12, 3)},
                             {"cube", test::box(Vec3::Constant(-0.1), Vec3::Constant(0.1))},
                             {"spiky star", test::spiky_star(0.18)}};
    if (const char* data = std::getenv("TOILE_TEST_DATA"); data && *data)
        rows.push_back({"real body", read_avatar(std::string(data) + "/bodies/f_smpl_average_A40.obj").body});
    for (int k = 0; k < count; ++k) run(rows[k % rows.size()], first + k, iterations);
    std::puts("| body | scenes | nodes, mean | at rest | steps of a flight that cross | crossings at the end | nodes inside | "
              "least clearance, mm | CPU s per scene |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|");
    int bad = 0;
    for (const Row& r : rows) {
        if (r.scenes == 0) continue;
        std::printf("| %s | %d | %ld | %d | %d | %d | %d | %.4f | %.1f |\n", r.name, r.scenes, r.nodes / r.scenes, r.at_rest,
                    r.crossing_flight, r.crossings, r.inside, 1e3 * r.clearance, r.seconds / r.scenes);
        bad += r.crossing_flight + r.crossings + r.inside;
    }
    return bad != 0;
}
