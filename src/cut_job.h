// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// From files to files: read a body and lines on it, cut a surface round it along them, write the pieces as a pattern.

#include "sewing/cut_pattern.h"

#include <string>
#include <vector>

namespace toile {

struct CutJob {
    std::string body;   ///< file: a closed body, or with offset 0 any mesh, which is cut itself
    double offset = 0;  ///< m from the body, [0, 0.2]
    double edge = 0.01; ///< m, of the triangles of the offset surface
    std::string lines;  ///< file
    std::string output; ///< pattern to write
    std::string surface; ///< OBJ to write of the pieces as they were cut; empty: not written
    std::string preview; ///< PNG of the strain; empty: not written
    std::string report;  ///< file; empty: not written
};

struct CutOutcome {
    std::vector<CutPiece> pieces;
    Pattern pattern;
    std::string report;               ///< JSON text, described in docs/cut.md
    std::vector<std::string> written; ///< files
};

/// Does the job. Throws InputError (a sentence) when a file is refused or a target cannot be written, before anything is.
CutOutcome run_cut(const CutJob& job);

} // namespace toile
