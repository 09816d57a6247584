// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "src/command_line.h"
#include "tests/support/temp_folder.h"

#include <algorithm>
#include <fstream>
#include <sstream>

namespace toile::test {

struct Run {
    int code = -1;
    std::string out, err;
};

inline Run run_toile(const std::vector<std::string>& arguments) {
    std::ostringstream out, err;
    Run r;
    r.code = run_command_line(arguments, {out, err, false});
    r.out = out.str();
    r.err = err.str();
    return r;
}

/// Whether a failure spoke one sentence and no more.
inline bool one_sentence(const std::string& err) {
    return err.starts_with("toile: ") && err.size() > 20 && std::count(err.begin(), err.end(), '\n') == 1 &&
           err.back() == '\n';
}

inline std::string write_text(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
    return path;
}

/// A skirt of two rectangles, `width` x `height` in the file's units, 100 to the metre, sewn at the sides and
/// hung well in front of and behind the body.
inline std::string skirt_pattern(double width = 60, double height = 50) {
    std::ostringstream s;
    const auto panel = [&](const char* name, double z, double turn) {
        s << '"' << name << R"(": {"translation": [0, 60, )" << z << R"(], "rotation": [0, )" << turn
          << R"(, 0], "vertices": [[)" << -width / 2 << ",0],[" << width / 2 << ",0],[" << width / 2 << ','
          << height << "],[" << -width / 2 << ',' << height
          << R"(]], "edges": [{"endpoints":[0,1]},{"endpoints":[1,2]},{"endpoints":[2,3]},{"endpoints":[3,0]}]})";
    };
    s << R"({"pattern": {"panels": {)";
    panel("front", 25, 0);
    s << ", ";
    panel("back", -25, 180);
    s << R"(}, "stitches": [[{"panel":"front","edge":1},{"panel":"back","edge":3}],)"
      << R"([{"panel":"front","edge":3},{"panel":"back","edge":1}]], "panel_order": ["front","back"]},)"
      << R"("properties": {"units_in_meter": 100, "curvature_coords": "relative", "normalize_panel_translation": false,)"
      << R"("normalized_edge_loops": true}})";
    return s.str();
}

} // namespace toile::test
