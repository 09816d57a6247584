// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A garment of examples/ on the built-in form, with alterations of every kind, draped and at rest with its friction frozen.

#include "draping/fit/altered_drape.h"
#include "src/drape_input.h"
#include "src/pipeline.h"

namespace toile::test {

struct FitScene {
    MovingFlat moving;
    PanelFabrics fabrics;
    TriMesh body;
    DrapeOptions options;
    DrapeResult drape;

    Eigen::VectorXd drawn() const { return Eigen::VectorXd::Zero(Eigen::Index(moving.alterations.size())); }
};

inline Pattern example_pattern(const std::string& name) {
    std::vector<std::string> warnings;
    return sound_pattern(std::string(TOILE_SOURCE_DIR "/examples/") + name + ".json", warnings);
}

inline FitScene fit_scene(const Pattern& pattern, std::vector<Alteration> alterations, double edge_length) {
    FitScene s;
    DrapeInput input = input_of(pattern, "", edge_length);
    s.moving = moving_flat(pattern, flat_of(pattern, edge_length), std::move(alterations));
    s.fabrics = input.fabrics;
    s.body = read_body("", {}, false).mesh;
    s.drape = drape(input.staging, {s.body, smoothed_toward_core(s.body, 0.01)}, s.fabrics, s.options);
    return s;
}

} // namespace toile::test
