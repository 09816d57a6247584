// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// From files to files: read a garment mesh and a body, untangle, write, inspect what was written.

#include "draping/untangle_garment.h"

#include <string>
#include <vector>

namespace toile {

struct UntangleJob {
    std::string garment; ///< file
    std::string avatar;  ///< file; empty: the body in the garment's file, if any
    bool repair_avatar = false;
    UntangleGarmentOptions untangle;
    std::function<bool()> interrupted; ///< whether untangle.progress stopped the work

    std::vector<std::string> garments; ///< files to write
    std::string report;                ///< file; empty: not written
};

struct UntangleOutcome {
    UntangledGarment result;
    std::string where;                ///< what could not be undone and where; empty when all was
    std::string report;               ///< JSON text, described in docs/untangle.md
    std::vector<std::string> written; ///< files
};

/// Does the job. Throws InputError (a sentence) when a file is refused or a target cannot be written, before anything
/// is. A garment that is not clear is written all the same, as the best state, and `result.status` says so. Written
/// garments are read again and inspected: what the report says of them, it says of the worst of them.
UntangleOutcome run_untangle(const UntangleJob& job);

} // namespace toile
