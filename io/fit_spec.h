// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What a fit may alter and what it is to reach, as a file: docs/fit.md.

#include "draping/fit/fit.h"
#include "io/input_error.h"

#include <string>
#include <vector>

namespace toile {

/// A goal as it is written, before there is a drape to name nodes and triangles of.
struct GoalSpec {
    enum class Kind { shape, level, ease, stretch } kind = Kind::shape;
    std::string name;
    std::string file;                    ///< shape: a garment, or any surface
    std::vector<std::array<int, 2>> edges; ///< level: panel and edge
    std::optional<double> height;        ///< m, of level and ease
    double amount = 0;                   ///< ease: m; stretch: strain
    bool warp = true;                    ///< stretch
    std::vector<int> panels;             ///< ease and stretch
    std::optional<Vec3> near;            ///< stretch: only cloth this near a place of the drape that the fit starts from, m
    double within = 0;                   ///< m
    double tolerance = 0;                ///< m, or a strain
};

struct FitSpec {
    std::vector<Alteration> alterations;
    std::vector<Elastic> put_in; ///< that alterations name after those of the pattern: as long as the cloth as drawn
    Eigen::VectorXd start;       ///< amounts
    std::vector<GoalSpec> goals;
    FitOptions options; ///< optimiser, max_evaluations, stay
};

/// Reads lengths in millimetres, stretch and shares in percent. Shape files are relative to the spec's folder. Throws InputError with
/// the place in the file: not JSON, unknown keys, panels, vertices, edges, seams or elastics that the pattern does not have, numbers out
/// of range, no alteration or no goal.
FitSpec read_fit_spec(const std::string& path, const Pattern& pattern);

} // namespace toile
