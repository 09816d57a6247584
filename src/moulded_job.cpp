// SPDX-License-Identifier: GPL-3.0-or-later
#include "src/moulded_job.h"

#include "io/preview.h"
#include "io/read_fabric.h"
#include "io/write_file.h"
#include "io/write_garment.h"
#include "sewing/mesh_grain.h"
#include "src/pipeline.h"
#include "src/rest_job.h"

#include <nlohmann/json.hpp>

namespace toile {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> targets(const MouldedJob& job) {
    std::vector<std::string> all;
    if (!job.output.empty()) all = moved_files(job.output, job.shape);
    for (const std::string& file : {job.preview, job.report})
        if (!file.empty()) all.push_back(file);
    return all;
}

Points warp_of(const ReadGarment& read) {
    const Garment& g = read.garment;
    Points warp(g.triangles.size(), Vec3::UnitY());
    for (int t = 0; read.flat && t < int(g.triangles.size()); ++t) {
        const Triangle n = g.nodes(t), &v = g.triangles[t];
        const Vec3 along = flat_warp(read.x[n[1]] - read.x[n[0]], read.x[n[2]] - read.x[n[0]], g.uv[v[1]] - g.uv[v[0]],
                                     g.uv[v[2]] - g.uv[v[0]]);
        if (along.norm() > 0) warp[t] = along;
    }
    return warp;
}

} // namespace

MouldedOutcome run_moulded(const MouldedJob& job) {
    refuse_targets({job.shape, fabric_file(job.fabric)}, targets(job));
    const ReadGarment read = read_garment(job.shape);
    const Prescribed shape = measured_in(job.shape, read);
    const Fabric fabric = fabric_called(job.fabric);
    MouldedOutcome outcome;
    outcome.states = resting_states(moulded_cloth(shape.triangles, read.x, warp_of(read)), fabric, read.x);
    outcome.written = targets(job);
    const std::vector<FoundShape>& found = outcome.states.found;

    Json report{{"toile", TOILE_VERSION}, {"status", found.empty() ? "stalled" : "found"}, {"fabric", fabric.name}};
    report["points"] = shape.point_count;
    report["starts"] = outcome.states.starts;
    report["unsettled"] = outcome.states.unsettled;
    report["states"] = states_json(shape, found, "residual");
    outcome.report = report.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';

    write_states(job.output, job.all_states, job.shape, read, found, outcome.written);
    if (!job.preview.empty()) write_preview(job.preview, read.garment, found.empty() ? read.x : found[0].shape.x, {});
    if (!job.report.empty()) write_file(job.report, outcome.report);
    return outcome;
}

} // namespace toile
