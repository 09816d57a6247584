// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/untangle_job.h"

#include "draping/inspect.h"
#include "geometry/parallel.h"
#include "geometry/text.h"
#include "io/read_garment.h"
#include "io/report.h"
#include "io/write_file.h"
#include "io/write_garment.h"
#include "src/pipeline.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <filesystem>

namespace fs = std::filesystem;

namespace toile {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

Json place(const Vec3& p) {
    return {p.x(), p.y(), p.z()};
}

int faults(const Inspection& i) {
    return i.intersections.cloth_avatar + i.intersections.cloth_cloth + i.inside.nodes;
}

std::vector<std::string> targets(const UntangleJob& job) {
    std::vector<std::string> all;
    for (const std::string& garment : job.garments)
        for (const std::string& file : moved_files(garment, job.garment))
            all.push_back(file);
    if (!job.report.empty()) all.push_back(job.report);
    return all;
}

/// What is left, with its places.
std::string what_is_left(const Inspection& i, const Garment& garment) {
    std::string where;
    for (std::size_t k = 0; k < i.crossings.size(); ++k) {
        const Crossing& c = i.crossings[k];
        if (k == 3) {
            where += text(", and %zu more places", i.crossings.size() - k);
            break;
        }
        where += (where.empty() ? "" : ", ") +
                 text("%zu pairs of %s cross at (%.3f, %.3f, %.3f) m on panel \"", c.pairs.size(),
                      c.with_body ? "cloth and body" : "cloth and cloth", c.at.x(), c.at.y(), c.at.z()) +
                 garment.panel_names[std::size_t(c.panels[0])] + '"';
    }
    if (i.inside.nodes > 0)
        where += (where.empty() ? "" : "; ") + text("%d nodes are in the body, the deepest by %.1f mm at (%.3f, %.3f, %.3f) m",
                                                    i.inside.nodes, 1e3 * i.inside.depth, i.inside.at.x(),
                                                    i.inside.at.y(), i.inside.at.z());
    return where;
}

Json change_json(const Change& c, int nodes) {
    return {{"nodes", nodes},
            {"moved_nodes", c.moved},
            {"displacement", {{"max", c.largest}, {"mean", c.mean}, {"at", place(c.at)}}},
            {"edge_length", {{"max", c.edge_largest}, {"mean", c.edge_mean}, {"at", place(c.edge_at)}}}};
}

/// A file names its materials beside itself.
void note_materials(const UntangleJob& job, std::vector<std::string>& notes) {
    const fs::path from = fs::weakly_canonical(job.garment).parent_path();
    for (const std::string& path : job.garments)
        if (garment_format(path) == GarmentFormat::obj && garment_format(job.garment) == GarmentFormat::obj &&
            fs::weakly_canonical(path).parent_path() != from)
            notes.push_back(path + " names the same material files as " + job.garment + ", which are not copied to its folder");
}

} // namespace

UntangleOutcome run_untangle(const UntangleJob& job) {
    const auto start = Clock::now();
    UntangleOutcome outcome;
    refuse_targets({job.garment, job.avatar}, targets(job));
    const ReadGarment read = read_garment(job.garment);
    std::vector<std::string> notes = read.notes;
    TriMesh body = read.avatar;
    if (!job.avatar.empty()) {
        Body other = read_body(job.avatar, {}, job.repair_avatar);
        notes.insert(notes.end(), other.notes.begin(), other.notes.end());
        body = std::move(other.mesh);
    }
    const Inspection before = inspect(read.garment, read.x, body);
    const double read_seconds = seconds_since(start);

    const auto work = Clock::now();
    UntangleGarmentOptions options = job.untangle;
    options.max_seconds -= read_seconds;
    outcome.result = untangle_garment(read.garment, read.x, body, options);
    const UntangledGarment& result = outcome.result;
    const double work_seconds = seconds_since(work);

    const auto writing = Clock::now();
    Inspection after = inspect(read.garment, result.x, body);
    for (const std::string& path : job.garments) {
        write_moved(path, job.garment, read, result.x);
        const ReadGarment again = read_garment(path);
        const Inspection written = inspect(again.garment, again.x, body);
        if (faults(written) > faults(after)) after = written;
    }
    if (result.status == UntangleStatus::clear && faults(after) > 0) outcome.result.status = UntangleStatus::tangled;
    note_materials(job, notes);
    outcome.where = what_is_left(after, read.garment);
    if (result.status == UntangleStatus::limit)
        outcome.where = (job.interrupted && job.interrupted() ? "stopped by a signal: " : "stopped by the time limit: ") + outcome.where;

    Json report{{"toile", TOILE_VERSION}, {"status", to_string(result.status)}, {"where", outcome.where}};
    report["clearance"] = job.untangle.clearance;
    report["before"] = inspection_json(before, read.garment);
    report["after"] = inspection_json(after, read.garment);
    report["change"] = change_json(result.change, read.garment.node_count);
    report["decisions"] = result.decisions;
    report["notes"] = notes;
    report["threads"] = threads();
    report["seconds"] = {{"read", read_seconds},
                         {"untangle", work_seconds},
                         {"write", seconds_since(writing)},
                         {"total", seconds_since(start)}};
    outcome.report = report.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
    if (!job.report.empty()) write_file(job.report, outcome.report);
    outcome.written = targets(job);
    return outcome;
}

} // namespace toile
