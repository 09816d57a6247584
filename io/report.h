// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/drape.h"

#include <string>

namespace toile {

/// What a report says beyond the drape's own result.
struct ReportContext {
    std::string input_hash;  ///< of pattern, avatar and options
    std::string fabric;
    int threads = 1;
    std::vector<StageSeconds> seconds; ///< stages outside drape(): read, triangulate, write
    std::vector<std::string> warnings; ///< from reading
    BodyMeasures body_measures;
};

/// The report as JSON text, valid by docs/report.schema.json.
std::string report_json(const DrapeResult& result, const TriMesh& body, const PanelFabrics& fabrics,
                        const ReportContext& context);

} // namespace toile
