// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// From files to files: read a mesh as it is to hang, find the rest shape with which it does, write that.

#include "draping/rest/sag_free.h"

#include <string>
#include <vector>

namespace toile {

struct SagFreeJob {
    std::string shape;  ///< file: the mesh as it is to hang, y up
    std::string hold;   ///< what holds it: numbers of points in the file from 1, "1,2,3", "borders", or a file of numbers
    std::string fabric = "poplin"; ///< preset or file
    SagFreeOptions options;

    std::string rest;    ///< file of the rest shape, JSON; empty: not written
    std::string preview; ///< PNG file of what is missing; empty: not written
    std::string report;  ///< file; empty: not written
};

struct SagFreeOutcome {
    SagFree found;
    std::string report;               ///< JSON text, described in docs/rest.md
    std::vector<std::string> written; ///< files
};

/// Does the job under the gravity of DrapeOptions. Throws InputError (a sentence) when a file or a point is refused or a target
/// cannot be written, before anything is. Where nothing within the bounds is in balance, the nearest is written.
SagFreeOutcome run_sag_free(const SagFreeJob& job);

} // namespace toile
