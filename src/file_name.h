// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace toile {

/// Letters and digits of a name, with single hyphens for the rest.
std::string file_name(const std::string& name);

} // namespace toile
