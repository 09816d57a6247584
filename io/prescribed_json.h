// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Lengths and angles that a mesh is told to have, as a file: docs/rest.md.

#include "draping/rest/prescribed.h"
#include "io/input_error.h"

#include <string>

namespace toile {

/// Changes the lengths and angles that the file names, among those that `data` has. `point_of_file` is the point at each of
/// the file's numbers, from 0; -1: none. Throws InputError with the place in the file: not JSON, unknown keys, points or
/// edges that the mesh does not have, numbers out of their range, lengths that no triangle has.
void read_prescribed(const std::string& path, const std::vector<int>& point_of_file, Prescribed& data);

/// Every length and angle, in the form that read_prescribed() takes; points by their numbers in the file, from 0.
std::string prescribed_text(const Prescribed& data, const std::vector<int>& file_point);

} // namespace toile
