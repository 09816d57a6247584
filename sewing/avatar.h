// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/tri_mesh.h"

namespace toile {

/// The body: a closed surface that can move. At s = 1 it is the whole avatar, at s = 0 its start, a shrunken
/// core; in between every point moves on a straight line. Metres, y up, +z to the front, feet near y = 0.
struct Avatar {
    TriMesh body;  ///< s = 1
    Points start;  ///< s = 0; as many points as the body

    Points at(double s) const;
};

/// The body smoothed toward its core: one implicit step of cotangent-weight mean curvature flow,
/// (M + t L) x' = M x, which does not depend on how the body is meshed. `time` in m2 (0.01: a third of the
/// volume is left; 0.03: little). Desbrun, Meyer, Schroder, Barr: Implicit Fairing of Irregular Meshes, 1999.
Points smoothed_toward_core(const TriMesh& body, double time);

/// Girths and heights of a standing body, found from its shape whatever its topology.
struct BodyMeasures {
    double height = 0;
    double bust_y = 0, waist_y = 0, hip_y = 0, neck_y = 0, crotch_y = 0; ///< metres above the floor
    double bust = 0, waist = 0, hip = 0;                                 ///< girths of the torso, metres
};
BodyMeasures measure_body(const TriMesh& body);

} // namespace toile
