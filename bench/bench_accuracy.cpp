// SPDX-License-Identifier: GPL-3.0-or-later
// What --accuracy promises and takes, as a table: bench_accuracy 2mm [name ...]. The true error is the RMS distance to the
// same drape continued at half its edge length. The uniform mesh beside it is the coarsest of a few (half as many triangles
// each) whose true error, found the same way, is as small; seconds are of the processor, since others may be at work.
// Patterns, bodies and fabrics as for bench_drape.
#include "bench/manifest.h"
#include "draping/compare.h"
#include "geometry/text.h"
#include "src/pipeline.h"
#include "src/quantity.h"
#include "tests/support/temp_folder.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

using namespace toile;

namespace {

constexpr double uniform_edges[] = {0.04, 0.028, 0.02, 0.014, 0.01}; // m

const char* const garments[] = {"tshirt",     "pencil_skirt",       "pants",        "shirt_mean", "levels_skirt",
                                "turtleneck", "fitted_shirt_darts", "dress_pencil", "shorts",     "rand_009"};

struct Timed {
    DrapeOutcome outcome;
    double seconds = 0;
};

Timed drape_timed(const DrapeJob& job) {
    const std::clock_t start = std::clock();
    Timed t{run_job(job), 0};
    t.seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
    return t;
}

/// Of a drape written to `file`, m; negative when the finer one does not come to rest.
double true_error(DrapeJob job, const DrapeResult& r, const std::string& file, double edge_length) {
    job.accuracy = 0;
    job.garments.clear();
    job.from = file;
    job.edge_length = edge_length / 2;
    const DrapeOutcome finer = run_job(job);
    return finer.result.status == DrapeStatus::converged ? compare(surface(r), surface(finer.result)).rms : -1;
}

std::string millimetres(double m) { return m < 0 ? "not at rest" : text("%.2f", 1e3 * m); }

void measure(const ManifestEntry& e, const std::string& data, double asked) {
    const test::TempFolder folder;
    DrapeJob job;
    job.pattern = pattern_file(data, e);
    job.avatar = body_file(data, e);
    job.fabric = e.fabric;
    job.garments = {folder / "a.obj"};
    DrapeJob chosen = job;
    chosen.accuracy = asked;
    const Timed t = drape_timed(chosen);
    const AccuracyReport& a = *t.outcome.result.accuracy;
    std::string meshes;
    for (const AccuracyMesh& m : a.meshes) meshes += text(meshes.empty() ? "%.3g" : ", %.3g", 1e3 * m.edge_length);
    const double error = true_error(job, t.outcome.result, job.garments[0], a.meshes.back().edge_length);
    std::printf("| %s | %.3g | %s | %d | %s | %s | %s | %.1f |", e.name.c_str(), 1e3 * asked, meshes.c_str(), a.meshes.back().vertices,
                a.estimate ? millimetres(*a.estimate).c_str() : "", millimetres(error).c_str(), to_string(t.outcome.result.status),
                t.seconds);
    std::fflush(stdout);
    std::string uniform = " none | | |";
    for (const double edge : uniform_edges) {
        DrapeJob plain = job;
        plain.edge_length = edge;
        const Timed u = drape_timed(plain);
        const double reached = true_error(plain, u.outcome.result, job.garments[0], edge);
        if (reached < 0 || reached > error) continue;
        uniform = text(" %.3g | %.2f | %.1f |", 1e3 * edge, 1e3 * reached, u.seconds);
        break;
    }
    std::printf("%s\n", uniform.c_str());
    std::fflush(stdout);
}

} // namespace

int main(int count, char** words) {
    const char* data = std::getenv("TOILE_TEST_DATA");
    if (!data || count < 2) {
        std::fprintf(stderr, "usage: TOILE_TEST_DATA=folder bench_accuracy LENGTH [NAME ...]\n");
        return 1;
    }
    const std::vector<std::string> names(words + 2, words + count);
    std::printf("| garment | asked mm | meshes mm | vertices | estimate mm | true error mm | status | CPU s | uniform mm | its true error mm "
                "| its CPU s |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const ManifestEntry& e : read_manifest(data)) {
        const auto is_this = [&](const std::string& name) { return name == e.name; };
        if (names.empty() ? std::any_of(std::begin(garments), std::end(garments), is_this)
                          : std::any_of(names.begin(), names.end(), is_this))
            measure(e, data, parse_length(words[1]));
    }
}
