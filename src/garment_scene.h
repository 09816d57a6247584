// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/chart/scene.h"

#include <string>

namespace toile {

/// The garment of a pattern, as it is named, on the built-in form: a coarse drape is carried to every mesh, from which each method comes to rest as by
/// `toile drape --from`. What is measured is the distance from the equilibrium on a finer mesh that began at the same drape. Throws
/// InputError when the pattern is refused. What `make` gives throws std::runtime_error when the default method does not come to rest.
Scene garment_scene(const std::string& pattern);

} // namespace toile
