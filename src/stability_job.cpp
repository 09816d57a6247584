// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/stability_job.h"

#include "io/stability_svg.h"
#include "io/stability_table.h"
#include "io/write_file.h"
#include "src/file_name.h"

#include <algorithm>
#include <filesystem>

namespace toile {

StabilityJobOutcome run_stability(const StabilityJob& job) {
    const std::filesystem::path page(job.page);
    const std::string stem = (page.parent_path() / page.stem()).string(), version = "toile " TOILE_VERSION;
    check_writable(job.page);
    StabilityJobOutcome outcome;
    for (const StabilityScene& scene : stability_scenes()) {
        if (!job.methods.empty() && std::find(job.methods.begin(), job.methods.end(), scene.method) == job.methods.end()) continue;
        if (job.options.progress) job.options.progress(std::string(to_string(scene.method)) + ", " + scene.name);
        outcome.maps.push_back(make_map(scene, job.options));
    }
    const auto write = [&](const std::string& path, const std::string& bytes) {
        write_file(path, bytes);
        outcome.written.push_back(path);
    };
    write(job.page, stability_page(outcome.maps, version));
    write(stem + ".csv", stability_csv(outcome.maps));
    outcome.json = stability_json(outcome.maps, version);
    write(stem + ".json", outcome.json);
    for (const StabilityMap& map : outcome.maps) write(stem + "-" + file_name(map_title(map)) + ".svg", stability_svg(map));
    return outcome;
}

} // namespace toile
