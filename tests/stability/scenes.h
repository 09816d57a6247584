// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Scenes of the map at the very places where theory has their boundaries.

#include "draping/stability/map.h"

#include <catch2/catch.hpp>

#include <cmath>

namespace toile::test {

inline StabilityScene stability_scene(Method method, const std::string& name) {
    for (const StabilityScene& s : stability_scenes())
        if (s.method == method && s.name == name) return s;
    throw std::runtime_error("no scene " + name + " of " + to_string(method));
}

/// Works at `before` and fails at `after` times the boundary (the other way round where it fails below), for every mesh and
/// stiffness. Returns how many columns have a boundary.
inline int check_boundary(const StabilityScene& scene, const std::vector<StabilityMesh>& meshes, const std::vector<double>& stiffness,
                          double before, double after) {
    int bounded = 0;
    for (const double k : stiffness)
        for (const StabilityMesh& mesh : meshes) {
            INFO(to_string(scene.method) << ", " << scene.name << ", " << to_string(mesh.kind) << " mesh " << mesh.seed << ", stiffness " << k);
            const double boundary = scene.run(mesh, k, {}).boundary;
            if (!std::isfinite(boundary) || boundary == 0) continue;
            ++bounded;
            std::vector<double> values{boundary * before, boundary * after};
            if (scene.whole) values = {std::floor(values[0]), std::ceil(values[1])};
            const StabilityColumn column = scene.run(mesh, k, values);
            INFO("boundary " << boundary << ", measured " << column.outcomes[0].measure << " and " << column.outcomes[1].measure);
            CHECK(column.outcomes[0].failure.empty() == scene.fails_above);
            CHECK(column.outcomes[1].failure.empty() != scene.fails_above);
        }
    return bounded;
}

} // namespace toile::test
