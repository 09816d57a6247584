// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Real patterns, bodies and reference values are not part of the project. Tests that use them are skipped,
// and say so, unless the environment variable TOILE_TEST_DATA names their folder.

#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace toile::test {

/// Path of a file or folder below TOILE_TEST_DATA; nothing, and a printed line, when it is not there.
inline std::optional<std::string> test_data(const std::string& relative) {
    const char* root = std::getenv("TOILE_TEST_DATA");
    if (!root || !*root) {
        WARN("skipped: TOILE_TEST_DATA is not set");
        return std::nullopt;
    }
    const auto path = (std::filesystem::path(root) / relative).lexically_normal();
    if (!std::filesystem::exists(path)) {
        WARN("skipped: there is no " << path.string());
        return std::nullopt;
    }
    return path.string();
}

/// The same for reference values, which lie in the folder `reference` beside that of the data.
inline std::optional<std::string> reference_data(const std::string& relative) {
    return test_data("../reference/" + relative);
}

} // namespace toile::test
