// SPDX-License-Identifier: GPL-3.0-or-later
// One pattern with every response to contact, as a table: bench_responses PATTERN EDGE_LENGTH [SECONDS].
#include "src/pipeline.h"
#include "src/quantity.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <cstdlib>

using namespace toile;

int main(int count, char** words) {
    if (count < 3) {
        std::fprintf(stderr, "usage: bench_responses PATTERN EDGE_LENGTH [SECONDS]\n");
        return 1;
    }
    std::printf("| response | guarantee | s | iterations or steps by level | status | residual | crossings with the body | "
                "of the cloth | unresolved |\n|---|---|---|---|---|---|---|---|---|\n");
    for (const ContactResponse response : {ContactResponse::barrier, ContactResponse::constraint, ContactResponse::penalty,
                                           ContactResponse::impulse, ContactResponse::rigid}) {
        DrapeJob job;
        job.pattern = words[1];
        job.edge_length = parse_length(words[2]);
        job.drape.contact = response;
        if (count > 3) job.drape.max_seconds = std::atof(words[3]);
        const DrapeOutcome outcome = run_job(job);
        const auto r = nlohmann::json::parse(outcome.report);
        std::string steps;
        for (const auto& level : r["levels"])
            steps += (steps.empty() ? "" : " / ") + std::to_string(level["iterations"].get<int>());
        std::printf("| %s | %s | %.1f | %s | %s | %.1e | %d | %d | %d |\n", to_string(response),
                    r["contact"]["guarantee"].get<std::string>().c_str(), r["seconds"]["total"].get<double>(),
                    steps.c_str(), r["status"].get<std::string>().c_str(), outcome.result.residual,
                    r["intersections"]["cloth_avatar"].get<int>(), r["intersections"]["cloth_cloth"].get<int>(),
                    r["contact"]["unresolved"].get<int>());
        std::fflush(stdout);
    }
}
