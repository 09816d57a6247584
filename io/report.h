// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/drape.h"
#include "draping/follow.h"
#include "draping/inspect.h"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>

namespace toile {

/// A frame of a body in motion that a garment followed.
struct FrameRow {
    int frame = 0; ///< its number
    FrameReport report;
};

/// What a report says beyond the drape's own result.
struct ReportContext {
    std::string input_hash; ///< of pattern, avatar and options
    std::string fabric;     ///< name of the garment's fabric
    std::string blas;       ///< the BLAS at work
    int threads = 1;
    double total_seconds = 0;           ///< wall time, file to file
    std::vector<StageSeconds> seconds;  ///< stages outside drape(): read, triangulate, write
    std::vector<std::string> decisions; ///< from reading: unit and up axis of the body, what was repaired
    std::vector<std::string> warnings;  ///< from checking
    std::optional<BodyMeasures> body_measures; ///< nothing: not a standing body, and no ease is measured
    /// A file of floats is written too: intersections and clearance are the worse of both.
    bool written_as_float = false;
    std::vector<FrameRow> frames; ///< of a sequence, after the first; its absence in a report means that there was none
};

/// The strains of a garment as reports and inspections give them.
nlohmann::ordered_json strain_json(const StrainMeasure& strain);

/// An inspection in SI units, panels by name.
nlohmann::ordered_json inspection_json(const Inspection& inspection, const Garment& garment);

/// The report, valid by docs/report.schema.json and described in docs/report.md. It measures the garment as
/// it lies; what cannot be measured (the clearance of nothing) is null.
nlohmann::ordered_json make_report(const DrapeResult& result, const TriMesh& body,
                                   const PanelFabrics& fabrics, const ReportContext& context);

/// The same as text.
std::string report_json(const DrapeResult& result, const TriMesh& body, const PanelFabrics& fabrics,
                        const ReportContext& context);

} // namespace toile
