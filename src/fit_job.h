// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// From files to files: drape a pattern, find the alterations with which its drape meets the goals of a spec, write the altered
// pattern, what has changed, and the drape.

#include "draping/fit/fit.h"
#include "sewing/form.h"

#include <functional>
#include <string>
#include <vector>

namespace toile {

struct FitJob {
    std::string pattern; ///< file
    std::string spec;    ///< file, docs/fit.md
    std::string avatar;  ///< file; empty: the built-in form
    bool repair_avatar = false;
    FormMeasures form;
    std::string fabric;        ///< as in DrapeJob
    double edge_length = 0.02; ///< m
    DrapeOptions drape;
    double max_seconds = 1e9;
    std::function<bool(int evaluations, double value)> progress; ///< of the search; false stops it

    std::string output;                ///< pattern file to write
    std::vector<std::string> garments; ///< of the altered drape
    std::string picture, report;       ///< SVG and JSON; empty: not written
};

struct FitOutcome {
    FitResult result;
    std::string report;               ///< JSON text, described in docs/fit.md
    std::vector<std::string> written; ///< files
};

/// Does the job. Throws InputError or std::invalid_argument, a sentence, when a file or a goal is refused, or the pattern as it
/// is does not come to rest: nothing is written then. Goals that are not met are a status: the nearest is written.
FitOutcome run_fit(const FitJob& job);

} // namespace toile
