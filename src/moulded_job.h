// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// From files to files: read the shape that cloth was moulded to, find all shapes in which it stays on its own, write them.

#include "draping/resting_states.h"

#include <string>
#include <vector>

namespace toile {

struct MouldedJob {
    std::string shape; ///< file: the mesh as it was moulded
    std::string fabric = "poplin"; ///< preset or file

    std::string output;      ///< file of the lowest state; empty: not written
    bool all_states = false; ///< the k-th is written beside it as name-k
    std::string preview;     ///< PNG file of the lowest state; empty: not written
    std::string report;      ///< file; empty: not written
};

struct MouldedOutcome {
    RestingStates states;
    std::string report;               ///< JSON text, described in docs/rest.md
    std::vector<std::string> written; ///< files
};

/// Does the job. Warp runs along v where the file has texture coordinates, else along y. Throws InputError (a sentence) when a
/// file is refused or a target cannot be written, before anything is.
MouldedOutcome run_moulded(const MouldedJob& job);

} // namespace toile
