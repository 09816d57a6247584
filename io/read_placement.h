// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Where a panel starts out, as specifications and companion files say it.

#include "geometry/types.h"
#include "io/json.h"

namespace toile {

/// [x, y, z] in units of `metres`. Throws InputError.
Vec3 read_vector(const JsonView& v, double metres);

/// [rx, ry, rz], degrees about x, y and z; z is applied last. Throws InputError.
Mat3 read_rotation(const JsonView& v);

} // namespace toile
