// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/chart_job.h"

#include "geometry/parallel.h"
#include "io/chart_page.h"
#include "io/chart_svg.h"
#include "io/write_file.h"
#include "sewing/blas.h"
#include "src/garment_scene.h"
#include "src/page_files.h"

#include <algorithm>
#include <fstream>

namespace toile {

namespace {

std::vector<Scene> scenes_asked(const std::vector<std::string>& names, const std::string& pattern) {
    std::vector<Scene> all = chart_scenes();
    if (!pattern.empty()) all.push_back(garment_scene(pattern));
    if (names.empty()) return all;
    std::vector<Scene> asked;
    std::string known;
    for (const Scene& s : all) {
        known += (known.empty() ? "'" : ", '") + s.name + "'";
        for (const std::string& name : names)
            if (s.name.starts_with(name)) {
                asked.push_back(s);
                break;
            }
    }
    for (const std::string& name : names) {
        bool found = false;
        for (const Scene& s : asked) found = found || s.name.starts_with(name);
        if (!found) throw InputError("no scene begins with '" + name + "', the scenes are " + known);
    }
    return asked;
}

/// As the system calls it.
std::string processor() {
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("model name")) return line.substr(std::min(line.size(), line.find(':') + 2));
    return "an unknown processor";
}

} // namespace

ChartOutcome run_chart(const ChartJob& job) {
    ChartOptions options = job.options;
    options.scenes = scenes_asked(job.scenes, job.pattern);
    if (options.methods.empty()) options.methods = all_methods();
    check_writable(job.page);
    ChartOutcome outcome;
    outcome.chart = make_chart(options);
    const ChartMachine machine{processor(), threads(), "toile " TOILE_VERSION, blas_name()};
    PageFiles files{chart_page(outcome.chart, machine), chart_csv(outcome.chart), chart_json(outcome.chart, machine), {}};
    for (const ChartScene& s : outcome.chart.scenes) files.pictures.push_back({s.scene.name, chart_svg(outcome.chart, s)});
    outcome.written = write_page(job.page, files);
    outcome.json = std::move(files.json);
    return outcome;
}

} // namespace toile
