// SPDX-License-Identifier: GPL-3.0-or-later
// Patterns with every method, as a table: bench_methods EDGE_LENGTH SECONDS PATTERN...
#include "src/pipeline.h"
#include "src/quantity.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

using namespace toile;

namespace {

void print_row(const std::string& name, const DrapeJob& job) {
    const DrapeOutcome outcome = run_job(job);
    const auto r = nlohmann::json::parse(outcome.report);
    std::string steps;
    double seconds = 0;
    for (const auto& level : r["levels"]) {
        steps += (steps.empty() ? "" : " / ") + std::to_string(level["iterations"].get<int>());
        seconds += level["seconds"].get<double>();
    }
    const auto percent = [&](const char* along) { return 100 * r["strain"][along]["max"].get<double>(); };
    std::printf("| %s | %s | %s | %.1f | %s | %.1f / %.1f | %.1e | %d / %d | %s | %s |\n", name.c_str(),
                to_string(job.drape.method), r["status"].get<std::string>().c_str(), seconds, steps.c_str(), percent("warp"),
                percent("weft"), outcome.result.residual, r["intersections"]["cloth_avatar"].get<int>(),
                r["intersections"]["cloth_cloth"].get<int>(), r["contact"]["response"].get<std::string>().c_str(),
                r["contact"]["guarantee"].get<std::string>().c_str());
    std::fflush(stdout);
}

} // namespace

int main(int count, char** words) {
    if (count < 4) {
        std::fprintf(stderr, "usage: bench_methods EDGE_LENGTH SECONDS PATTERN...\n");
        return 1;
    }
    std::printf("| pattern | method | status | s | iterations or steps by level | largest strain, warp / weft, %% | residual | "
                "crossings with body / cloth | response | guarantee |\n|---|---|---|---|---|---|---|---|---|---|\n");
    for (int i = 3; i < count; ++i)
        for (const Method method : all_methods()) {
            DrapeJob job;
            job.pattern = words[i];
            job.edge_length = parse_length(words[1]);
            job.drape.max_seconds = std::atof(words[2]);
            job.drape.method = method;
            print_row(std::filesystem::path(words[i]).stem().string(), job);
        }
}
