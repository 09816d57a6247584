// SPDX-License-Identifier: GPL-3.0-or-later
// Real garments from file to files, as a table: bench_drape 20mm [name ...]. Patterns, bodies and fabrics are those
// of garmentcode/MANIFEST.tsv in the folder that TOILE_TEST_DATA names, then those of garmentcode_2021; without names,
// all that are to be draped. A name that ends in .json is a pattern file, draped on the built-in form in its own fabric.
#include "bench/manifest.h"
#include "src/quantity.h"
#include "src/pipeline.h"
#include "tests/support/temp_folder.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>

using namespace toile;

namespace {

void drape_one(const ManifestEntry& e, const std::string& data, double edge_length) {
    const test::TempFolder folder;
    DrapeJob job;
    job.pattern = e.body.empty() ? e.name : pattern_file(data, e);
    if (!e.body.empty()) job.avatar = body_file(data, e);
    job.fabric = e.fabric;
    job.edge_length = edge_length;
    job.garments = {folder / "a.obj", folder / "a.glb"};
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu = std::clock();
    const DrapeOutcome outcome = run_job(job);
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double spent = double(std::clock() - cpu) / CLOCKS_PER_SEC;
    const auto r = nlohmann::json::parse(outcome.report);
    std::string iterations, factorisations;
    for (const LevelReport& level : outcome.result.levels) {
        iterations += (iterations.empty() ? "" : " / ") + std::to_string(level.iterations);
        if (level.part_iterations > 0) iterations += "+" + std::to_string(level.part_iterations);
        factorisations += (factorisations.empty() ? "" : " / ") + std::to_string(level.factorisations);
    }
    const auto& strain = r["strain"];
    std::printf("| %s | %s, %s | %d | %s | %s | %.1f | %.1f | %s | %.1e | %.2f, %.2f | %.1f | %.2f | %d, %d | %.0f | %.0f |\n",
                e.name.c_str(), e.body.empty() ? "form" : e.body.substr(0, e.body.find('.')).c_str(),
                r["fabric"].get<std::string>().c_str(),
                r["vertices"].get<int>(), iterations.c_str(), factorisations.c_str(), wall, spent,
                r["status"].get<std::string>().c_str(), r["residual"].get<double>(),
                100 * strain["warp"]["max"].get<double>(), 100 * strain["weft"]["max"].get<double>(),
                100 * strain["compressed_area"].get<double>(), 1e3 * r["clearance_min"].get<double>(),
                r["intersections"]["cloth_avatar"].get<int>(), r["intersections"]["cloth_cloth"].get<int>(),
                r["peak_memory_bytes"].get<double>() / 1e6,
                100 * r["seconds"]["contact"].get<double>() / r["seconds"]["total"].get<double>());
    std::fflush(stdout);
    if (outcome.result.status != DrapeStatus::converged) std::printf("<!-- %s -->\n", outcome.result.where.c_str());
}

} // namespace

int main(int count, char** words) {
    const char* data = std::getenv("TOILE_TEST_DATA");
    if (!data || count < 2) {
        std::fprintf(stderr, "usage: TOILE_TEST_DATA=folder bench_drape EDGE_LENGTH [NAME ...]\n");
        return 1;
    }
    const std::vector<std::string> names(words + 2, words + count);
    std::printf("| garment | body, fabric | vertices | iterations by level | factorisations | s | CPU s | status | residual | "
                "warp, weft max %% | compressed %% | clearance mm | crossings | MB | contact %% of s |\n"
                "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const std::string& name : names)
        if (name.ends_with(".json")) drape_one({name, "", "", ""}, data, parse_length(words[1]));
    std::vector<ManifestEntry> entries = read_manifest(data);
    const std::vector<ManifestEntry> older = patterns_of_2021(data);
    entries.insert(entries.end(), older.begin(), older.end());
    for (const ManifestEntry& e : entries) {
        const bool chosen = std::find(names.begin(), names.end(), e.name) != names.end();
        if (names.empty() ? e.expect != "refused" : chosen) drape_one(e, data, parse_length(words[1]));
    }
}
