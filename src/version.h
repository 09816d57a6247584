// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace toile {

/// Versions of toile and of the libraries it was built with, and the BLAS at work, a line each.
std::string version_text();

} // namespace toile
