// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The real garments of the folder that TOILE_TEST_DATA names: patterns with the body and fabric each is draped with.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace toile {

struct ManifestEntry {
    std::string name, body, fabric, expect;
    std::string folder = "garmentcode", ending = "_specification.json"; ///< of the pattern's file
};

/// The entries of garmentcode/MANIFEST.tsv in the folder `data`.
inline std::vector<ManifestEntry> read_manifest(const std::string& data) {
    std::vector<ManifestEntry> entries;
    std::ifstream file(data + "/garmentcode/MANIFEST.tsv");
    std::string line;
    std::getline(file, line); // the heading
    while (std::getline(file, line)) {
        std::istringstream fields(line);
        ManifestEntry e;
        for (std::string* field : {&e.name, &e.body, &e.fabric, &e.expect}) std::getline(fields, *field, '\t');
        e.name = e.name.substr(0, e.name.find(e.ending));
        entries.push_back(e);
    }
    return entries;
}

/// The patterns of the form of 2021 in the folder `data`, which come without a manifest: for the body of that time, in
/// jersey, since poplin's 3 % are too little for some.
inline std::vector<ManifestEntry> patterns_of_2021(const std::string& data) {
    std::vector<ManifestEntry> entries;
    for (const auto& file : std::filesystem::directory_iterator(data + "/garmentcode_2021"))
        if (file.path().extension() == ".json")
            entries.push_back({file.path().stem(), "f_smpl_template.obj", "jersey", "draped", "garmentcode_2021", ".json"});
    std::sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    return entries;
}

inline std::string pattern_file(const std::string& data, const ManifestEntry& e) {
    return data + "/" + e.folder + "/" + e.name + e.ending;
}

inline std::string body_file(const std::string& data, const ManifestEntry& e) { return data + "/bodies/" + e.body; }

} // namespace toile
