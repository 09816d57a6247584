// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/stability_job.h"

#include "io/stability_svg.h"
#include "io/stability_table.h"
#include "io/write_file.h"
#include "src/page_files.h"

#include <algorithm>

namespace toile {

StabilityJobOutcome run_stability(const StabilityJob& job) {
    const std::string version = "toile " TOILE_VERSION;
    check_writable(job.page);
    StabilityJobOutcome outcome;
    for (const StabilityScene& scene : stability_scenes()) {
        if (!job.methods.empty() && std::find(job.methods.begin(), job.methods.end(), scene.method) == job.methods.end()) continue;
        if (job.options.progress) job.options.progress(std::string(to_string(scene.method)) + ", " + scene.name);
        outcome.maps.push_back(make_map(scene, job.options));
    }
    PageFiles files{stability_page(outcome.maps, version), stability_csv(outcome.maps), stability_json(outcome.maps, version), {}};
    for (const StabilityMap& map : outcome.maps) files.pictures.push_back({map_title(map), stability_svg(map)});
    outcome.written = write_page(job.page, files);
    outcome.json = std::move(files.json);
    return outcome;
}

} // namespace toile
