// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace toile::test {

/// Whether the Khronos validator passes a GLB without error or warning; nothing when it is not installed
/// (scripts/test puts it into build/npm where npm is at hand).
inline std::optional<bool> khronos_accepts(const std::string& path) {
    const std::string source = TOILE_SOURCE_DIR, modules = source + "/build/npm/node_modules";
    if (!std::filesystem::exists(modules + "/gltf-validator") ||
        std::system("node --version > /dev/null 2>&1") != 0)
        return std::nullopt;
    const std::string command =
        "NODE_PATH='" + modules + "' node '" + source + "/tests/support/validate_glb.js' '" + path + "'";
    return std::system(command.c_str()) == 0;
}

} // namespace toile::test
