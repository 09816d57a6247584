// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/stability/map.h"

#include "geometry/parallel.h"

#include <algorithm>
#include <cmath>

namespace toile {

std::vector<StabilityMesh> stability_meshes(int seeds) {
    std::vector<StabilityMesh> meshes;
    for (const MeshKind kind : {MeshKind::aligned, MeshKind::alternating, MeshKind::unstructured})
        for (int seed = 0; seed <= seeds; ++seed) meshes.push_back({kind, seed});
    return meshes;
}

const char* to_string(MeshKind kind) {
    switch (kind) {
    case MeshKind::aligned: return "aligned";
    case MeshKind::alternating: return "alternating";
    case MeshKind::unstructured: return "unstructured";
    }
    return "aligned";
}

std::vector<double> spread_values(double low, double high, int count, bool whole) {
    std::vector<double> values;
    for (int k = 0; k < count; ++k) {
        double value = low * std::pow(high / low, count > 1 ? double(k) / (count - 1) : 0);
        if (whole) value = std::round(value);
        if (values.empty() || value > values.back()) values.push_back(value);
    }
    return values;
}

StabilityMap make_map(const StabilityScene& scene, const StabilityOptions& options) {
    StabilityMap map{scene, spread_values(least_stiffness, most_stiffness, options.columns, false),
                     spread_values(scene.low, scene.high, options.rows, scene.whole), {}};
    const int meshes = int(options.meshes.size()), rows = int(map.values.size());
    map.runs.resize(map.stiffness.size() * options.meshes.size() * map.values.size());
    const int own = (scene.stiffness_matters ? int(map.stiffness.size()) : 1) * meshes; // columns to run
    parallel_for(own, 1, [&](int begin, int end) {
        for (int c = begin; c < end; ++c) {
            const double stiffness = map.stiffness[c / meshes];
            const StabilityMesh& mesh = options.meshes[c % meshes];
            StabilityColumn column = scene.run(mesh, stiffness, map.values);
            for (int k = 0; k < rows; ++k)
                map.runs[c * rows + k] = {mesh, stiffness, map.values[k], column.boundary, std::move(column.outcomes[k])};
        }
    });
    for (std::size_t i = std::size_t(own) * rows; i < map.runs.size(); ++i) {
        map.runs[i] = map.runs[i % (std::size_t(own) * rows)];
        map.runs[i].stiffness = map.stiffness[i / (std::size_t(meshes) * rows)];
    }
    return map;
}

bool should_fail(const StabilityScene& scene, const StabilityRun& run) {
    return scene.fails_above ? run.value > run.boundary : run.value < run.boundary;
}

StabilityCount compare_with_theory(const StabilityMap& map, double band) {
    StabilityCount count;
    for (const StabilityRun& run : map.runs) {
        const bool fails = !run.outcome.failure.empty(), should = should_fail(map.scene, run);
        count.failed += fails;
        if (run.value < run.boundary * band && run.value > run.boundary / band)
            ++count.left_out;
        else if (fails == should)
            ++count.as_theory;
        else
            ++(fails ? count.earlier : count.later);
    }
    return count;
}

} // namespace toile
