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

/// Girths and heights of a standing body, found from its shape whatever its topology and pose (arms down, apart
/// or level). Heights are y in the body's frame; girths are what a tape measure reads round the torso, metres.
struct BodyMeasures {
    double height = 0;   ///< from the lowest to the highest point
    double crotch_y = 0; ///< where one section becomes two legs
    double hip_y = 0;    ///< largest girth between crotch and waist
    double waist_y = 0;  ///< smallest girth between hip and bust
    double bust_y = 0;   ///< fullest front between waist and armpits
    double armpit_y = 0; ///< where the arms join the torso
    double neck_y = 0;   ///< smallest girth between armpits and head
    double bust = 0, waist = 0, hip = 0, neck = 0;
};

/// Throws std::invalid_argument when the shape has no torso on two legs.
BodyMeasures measure_body(const TriMesh& body);

/// What a tape measure reads round the torso at height y (arms left out where they are apart); 0 where there is
/// no section.
double torso_girth(const TriMesh& body, double y);

} // namespace toile
