// SPDX-License-Identifier: GPL-3.0-or-later
// The rules of CONTRIBUTING.md that a machine can check: which file may include which, and the licence line.
#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

/// What may be included stands to the left.
const Strings modules = {"geometry", "patterns", "sewing", "draping", "io", "src"};
const Strings draping_rooms = {"algebra", "fabric", "energy", "nonconforming", "contact", "solve", "rest"};
const Strings late_rooms = {"fit", "chart", "stability"}; ///< which files directly in draping/ may not include

/// Libraries that cost minutes of compiling or belong behind one door, by the start of their headers, and the
/// files that may include them.
// src/version.cpp asks every library for its version and includes no more than the header that has it.
const std::map<std::string, Strings> doors = {
    {"CGAL/", {"geometry/inside.cpp", "geometry/intersections.cpp", "patterns/triangulate_cgal.cpp", "src/version.cpp"}},
    {"cholmod.h", {"sewing/sparse_solve.cpp", "draping/algebra/cholesky.cpp", "src/version.cpp"}},
    {"suitesparse/", {}},
    {"nlopt", {"draping/rest/nearest_lbfgs.cpp", "draping/fit/optimise.cpp"}},
    {"assimp/", {"io/read_polygons.cpp", "src/version.cpp"}},
    {"embree3/", {"io/preview.cpp", "src/version.cpp"}},
    {"meshoptimizer", {"geometry/simplify.cpp", "src/version.cpp"}},
    {"tbb/", {"geometry/parallel.cpp", "src/version.cpp"}},
    {"oneapi/tbb", {}},
};

Strings split(const std::string& path) {
    Strings parts;
    std::istringstream in(path);
    for (std::string part; std::getline(in, part, '/');)
        parts.push_back(part);
    return parts;
}

std::optional<int> place_in(const Strings& order, const std::string& name) {
    const auto at = std::find(order.begin(), order.end(), name);
    if (at == order.end()) return std::nullopt;
    return int(at - order.begin());
}

/// Files directly in draping/ stand to the right of its rooms, but for late ones.
std::optional<int> room(const Strings& path) {
    const int files = int(draping_rooms.size());
    if (path.size() == 2) return files;
    if (const auto late = place_in(late_rooms, path[1])) return files + 1 + *late;
    return place_in(draping_rooms, path[1]);
}

/// What is wrong with `file` including `header` in quotes; empty when nothing is.
std::string wrong_own_include(const std::string& file, const std::string& header) {
    const Strings from = split(file), to = split(header);
    const auto from_module = place_in(modules, from[0]), to_module = place_in(modules, to[0]);
    if (!from_module) return ""; // tests and benches may include everything
    if (to.size() < 2 || !to_module)
        return "expected a path from the root of the project, beginning with a module";
    if (*to_module > *from_module) return "the module " + to[0] + " stands to the right of " + from[0];
    if (from[0] != "draping" || to[0] != "draping") return "";
    const auto from_room = room(from), to_room = room(to);
    if (!from_room || !to_room) return "a folder of draping/ is missing in the order of this test";
    if (*to_room > *from_room) return header + " stands to the right of draping/" + from[1];
    return "";
}

std::string wrong_library_include(const std::string& file, const std::string& header) {
    if (!place_in(modules, split(file)[0])) return "";
    for (const auto& [start, files] : doors)
        if (header.rfind(start, 0) == 0 && std::find(files.begin(), files.end(), file) == files.end())
            return "this library belongs behind a header of the project's own; see CONTRIBUTING.md";
    return "";
}

/// The header that a line includes, and its first delimiter; empty for other lines.
struct Include {
    char delimiter = 0;
    std::string header;
};

Include include_in(std::string line) {
    const auto skip = [&](const std::string& word) {
        line.erase(0, line.find_first_not_of(" \t"));
        if (line.rfind(word, 0) != 0) return false;
        line.erase(0, word.size());
        return true;
    };
    if (!skip("#") || !skip("include") || !skip("") || line.empty()) return {};
    const auto end = line.find_first_of("\">", 1);
    if ((line[0] != '"' && line[0] != '<') || end == std::string::npos) return {};
    return {line[0], line.substr(1, end - 1)};
}

Strings wrong_includes(const std::string& file, const std::string& text) {
    Strings wrong;
    std::istringstream in(text);
    int number = 1;
    for (std::string line; std::getline(in, line); ++number) {
        const Include found = include_in(line);
        if (found.header.empty()) continue;
        const std::string what = found.delimiter == '"' ? wrong_own_include(file, found.header)
                                                        : wrong_library_include(file, found.header);
        if (!what.empty())
            wrong.push_back(file + ":" + std::to_string(number) + " includes " + found.header + ": " + what);
    }
    return wrong;
}

/// In the first line, or the second when the first one names an interpreter.
bool has_licence(const std::string& text) {
    std::istringstream in(text);
    std::string line;
    std::getline(in, line);
    if (line.rfind("#!", 0) == 0) std::getline(in, line);
    return line == "// SPDX-License-Identifier: GPL-3.0-or-later" ||
           line == "# SPDX-License-Identifier: GPL-3.0-or-later";
}

std::string read(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

bool is_source(const fs::path& path) {
    static const Strings endings = {".h", ".cpp", ".c", ".cmake", ".py", ".sh"};
    const std::string folder = path.begin()->string();
    return std::find(endings.begin(), endings.end(), path.extension().string()) != endings.end() ||
           path.filename() == "CMakeLists.txt" || (folder == "scripts" && path.extension().empty());
}

/// Sources of the project, as paths from its root.
Strings sources() {
    static const Strings folders = {"geometry", "patterns", "sewing", "draping", "io",   "src",
                                    "tests",    "bench",    "cmake",  "scripts", "docs", "examples"};
    const fs::path root = TOILE_SOURCE_DIR;
    Strings found = {"CMakeLists.txt"};
    for (const std::string& folder : folders) {
        if (!fs::exists(root / folder)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
            const fs::path path = entry.path().lexically_relative(root);
            if (entry.is_regular_file() && is_source(path)) found.push_back(path.generic_string());
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

/// What stands between two marks, each time.
Strings between(const std::string& text, const std::string& begin, const std::string& end) {
    Strings found;
    for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
        at += begin.size();
        const std::size_t to = text.find(end, at);
        if (to == std::string::npos) break;
        found.push_back(text.substr(at, to - at));
        at = to + end.size();
    }
    return found;
}

/// Paths and pages that a page names and that do not exist.
Strings missing_paths(const std::string& page) {
    const fs::path root = TOILE_SOURCE_DIR;
    Strings missing;
    for (const std::string& path : between(page, "`", "`"))
        if (path.find('/') != std::string::npos && !fs::exists(root / path)) missing.push_back(path);
    for (const std::string& link : between(page, "](", ")"))
        if (!fs::exists(root / "docs" / link)) missing.push_back(link);
    return missing;
}

} // namespace

TEST_CASE("the check of includes sees what it is meant to see") {
    const auto wrong = [](const std::string& file, const std::string& line) {
        return !wrong_includes(file, line).empty();
    };
    CHECK_FALSE(wrong("sewing/garment.h", "#include \"patterns/pattern.h\""));
    CHECK_FALSE(wrong("sewing/garment.cpp", "#include \"sewing/garment.h\""));
    CHECK(wrong("geometry/bvh.cpp", "#include \"sewing/garment.h\""));
    CHECK(wrong("draping/drape.cpp", "  #  include \"io/report.h\""));
    CHECK(wrong("draping/measure.cpp", "#include \"measure.h\""));
    CHECK_FALSE(wrong("draping/solve/settle.cpp", "#include \"draping/energy/patch.h\""));
    CHECK_FALSE(wrong("draping/drape.cpp", "#include \"draping/solve/settle.h\""));
    CHECK(wrong("draping/energy/patch.cpp", "#include \"draping/solve/settle.h\""));
    CHECK(wrong("draping/contact/barrier.cpp", "#include \"draping/measure.h\""));
    CHECK_FALSE(wrong("draping/fit/thing.cpp", "#include \"draping/measure.h\""));
    CHECK(wrong("draping/drape.cpp", "#include \"draping/fit/thing.h\""));
    CHECK(wrong("draping/new/thing.cpp", "#include \"draping/measure.h\""));
    CHECK(wrong("draping/drape.cpp", "#include <CGAL/box_intersection_d.h>"));
    CHECK(wrong("geometry/bvh.cpp", "#include <tbb/parallel_for.h>"));
    CHECK_FALSE(wrong("geometry/intersections.cpp", "#include <CGAL/box_intersection_d.h>"));
    CHECK_FALSE(wrong("geometry/bvh.cpp", "#include <vector>"));
    CHECK_FALSE(wrong("tests/io/test_x.cpp", "#include \"tests/support/random.h\""));
    CHECK(wrong_includes("geometry/a.h", "\n#include \"io/report.h\"\n")[0].find("geometry/a.h:2 ") == 0);

    CHECK(has_licence("// SPDX-License-Identifier: GPL-3.0-or-later\n#pragma once\n"));
    CHECK(has_licence("#!/bin/sh\n# SPDX-License-Identifier: GPL-3.0-or-later\n"));
    CHECK_FALSE(has_licence("#pragma once\n// SPDX-License-Identifier: GPL-3.0-or-later\n"));
}

TEST_CASE("modules include leftward only and heavy libraries stay behind their doors") {
    const Strings files = sources();
    REQUIRE(files.size() > 50);
    for (const std::string& file : files) {
        if (fs::path(file).extension() != ".h" && fs::path(file).extension() != ".cpp") continue;
        for (const std::string& wrong : wrong_includes(file, read(fs::path(TOILE_SOURCE_DIR) / file)))
            FAIL_CHECK(wrong);
    }
}

TEST_CASE("every source file carries its licence line") {
    for (const std::string& file : sources()) {
        INFO(
            file << " should begin with the line \"SPDX-License-Identifier: GPL-3.0-or-later\" as a comment");
        CHECK(has_licence(read(fs::path(TOILE_SOURCE_DIR) / file)));
    }
}

TEST_CASE("the page that says where each topic is names what exists") {
    CHECK(missing_paths("`draping/drape.h` and `beyond` [x](methods.md)").empty());
    CHECK(missing_paths("`draping/no.h`, [x](no.md)") == Strings{"draping/no.h", "no.md"});
    const std::string page = read(fs::path(TOILE_SOURCE_DIR) / "docs/sources.md");
    REQUIRE(between(page, "`", "`").size() > 80);
    for (const std::string& missing : missing_paths(page)) FAIL_CHECK("docs/sources.md names " << missing);
}
