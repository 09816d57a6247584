// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "src/pipeline.h"
#include "tests/support/sound.h"

namespace toile::test {

/// Runs a job of one fabric, which must converge, and checks every garment file that it wrote.
inline DrapeOutcome drape_soundly(const DrapeJob& job, const std::string& fabric, double compressed,
                                  double outside = 0.97) {
    DrapeOutcome drape = run_job(job);
    INFO(drape.result.where);
    CHECK(drape.result.status == DrapeStatus::converged);
    for (const std::string& file : job.garments) {
        const ReadGarment g = read_garment(file);
        check_sound(g, drape.body, PanelFabrics(g.garment.panel_names.size(), fabric_preset(fabric)), compressed, outside);
    }
    return drape;
}

} // namespace toile::test
