// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The real garments of the folder that TOILE_TEST_DATA names: patterns with the body and fabric each is draped with.

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace toile {

struct ManifestEntry {
    std::string name, body, fabric, expect;
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
        e.name = e.name.substr(0, e.name.find("_specification"));
        entries.push_back(e);
    }
    return entries;
}

inline std::string pattern_file(const std::string& data, const ManifestEntry& e) {
    return data + "/garmentcode/" + e.name + "_specification.json";
}

inline std::string body_file(const std::string& data, const ManifestEntry& e) { return data + "/bodies/" + e.body; }

} // namespace toile
