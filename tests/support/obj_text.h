// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/text.h"
#include "geometry/tri_mesh.h"

namespace toile::test {

/// The mesh as an OBJ file, to the last bit.
inline std::string obj_text(const TriMesh& mesh) {
    std::string out;
    for (const Vec3& p : mesh.points) out += text("v %.17g %.17g %.17g\n", p.x(), p.y(), p.z());
    for (const Triangle& t : mesh.triangles) out += text("f %d %d %d\n", t[0] + 1, t[1] + 1, t[2] + 1);
    return out;
}

} // namespace toile::test
